// Reads PDOs from a file.
#include <algorithm>
#include <limits>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "pdo/pdo_recipes.hpp"
#include "show/field_reader.hpp"

namespace servoctl::pdo {
namespace {

using drive::PdoFile;
using drive::PdoRecipe;
using report::List;
using report::Value;

constexpr std::string_view kKeys[] = {"pdo",  "map",        "cob_id",   "valid",
                                      "type", "inhibit_us", "event_ms", "sync_start"};

/// Reads one element of the list; a key that is misspelt would silently not hold.
std::optional<Message> read_recipe(const Value& record, const Message& where, PdoRecipe& out) {
  const auto* fields = std::get_if<report::Record>(&record.data());
  if (fields == nullptr) return message("{} is not an object", where);
  for (const auto& field : *fields)
    if (std::find(std::begin(kKeys), std::end(kKeys), field.key) == std::end(kKeys))
      return message("{}: unknown key '{}'", where, as_it_is(field.key));
  show::FieldReader reader(record, where);
  out.pdo = reader.text("pdo", true);
  out.cob_id = reader.text("cob_id");
  const auto number = [&](std::string_view key, auto& target) {
    const auto value = reader.number(key);
    if (!value) return;
    if (*value > std::numeric_limits<typename std::decay_t<decltype(target)>::value_type>::max())
      reader.refuse(key);
    else
      target = static_cast<typename std::decay_t<decltype(target)>::value_type>(*value);
  };
  number("type", out.type);
  number("inhibit_us", out.inhibit_us);
  number("event_ms", out.event_ms);
  number("sync_start", out.sync_start);
  if (report::find(record, "valid") != nullptr) out.valid = reader.flag("valid");
  if (const auto* map = report::find(record, "map")) {
    const auto* list = std::get_if<List>(&map->data());
    if (list == nullptr) reader.refuse("map");
    out.map.emplace();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      const auto* word = std::get_if<std::string>(&(*list)[i].data());
      if (word == nullptr)
        reader.refuse("map");
      else
        out.map->push_back(*word);
    }
  }
  return reader.error();
}

Result<PdoFile> read_json(std::string_view text, const std::string& file) {
  const auto root = report::parse_json(text, file);
  if (!root) return fail(root.error());
  show::FieldReader reader(*root, as_it_is(file));
  PdoFile out;
  out.family = reader.text("family");
  if (reader.number("format", true).value_or(0) != 1) reader.refuse("format");
  const auto* pdos = report::find(*root, "pdo");
  const auto* list = pdos == nullptr ? nullptr : std::get_if<List>(&pdos->data());
  if (list == nullptr) reader.refuse("pdo");
  auto error = reader.error();
  for (std::size_t i = 0; list != nullptr && i < list->size() && !error; ++i)
    error = read_recipe((*list)[i], message("{}: pdo {}", as_it_is(file), i + 1), out.pdos.emplace_back());
  if (error) return fail(Errc::file, *error, "`pdo save` writes such a file");
  return out;
}

}  // namespace

Result<PdoFile> parse_pdo_file(std::string_view text, const std::filesystem::path& file) {
  if (lower(file.extension().string()) == ".json") return read_json(text, file.string());
  return drive::parse_pdo_file(text, file.string());
}

Result<PdoFile> read_pdo_file(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return fail(text.error());
  return parse_pdo_file(*text, file);
}

}  // namespace servoctl::pdo
