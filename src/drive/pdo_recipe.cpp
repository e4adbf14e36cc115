#include "drive/pdo_recipe.hpp"

#include "base/format.hpp"
#include "drive/pdo_recipe_reader.hpp"
#include "drive/toml_depth.hpp"

namespace servoctl::drive {
namespace {

Result<void> read_recipe(const TableReader& reader, PdoRecipe& out) {
  return reader.read({{"pdo", into(out.pdo)},
                      {"map", [&](const toml::node& n) { return get(n, out.map.emplace()); }},
                      {"cob_id", into(out.cob_id)},
                      {"valid", into(out.valid)},
                      {"type", into(out.type)},
                      {"inhibit_us", into(out.inhibit_us)},
                      {"event_ms", into(out.event_ms)},
                      {"sync_start", into(out.sync_start)}});
}

}  // namespace

bool get(const toml::node& node, PdoRecipe& out) {
  const auto* table = node.as_table();
  out.line = node.source().begin.line;
  return table != nullptr && read_recipe(TableReader(*table, ""), out) && !out.pdo.empty();
}

bool get(const toml::node& node, PdoPreset& out) {
  const auto* table = node.as_table();
  const auto pdos = [&](const toml::node& n) {
    return get_list(n, out.pdos, [](const toml::node& each, PdoRecipe& o) { return get(each, o); });
  };
  return table != nullptr && TableReader(*table, "").read({{"name", into(out.name)}, {"pdos", pdos}}) &&
         !out.name.empty();
}

Result<void> read_recipes(const toml::array& list, std::string_view file, std::vector<PdoRecipe>& out) {
  for (const auto& each : list) {
    const auto at = each.source().begin;
    const auto* table = each.as_table();
    if (table == nullptr)
      return fail(file_error(file, at.line, at.column, message("a PDO cannot be {}", value_in_words(each))));
    const TableReader reader(*table, file);
    out.emplace_back().line = at.line;
    if (const auto read = read_recipe(reader, out.back()); !read) return read;
    if (out.back().pdo.empty()) return reader.fail_at(each, "'pdo' is missing");
  }
  return {};
}

Result<PdoFile> parse_pdo_file(std::string_view toml, std::string_view file) {
  if (const auto flat = check_toml_depth(toml, file); !flat) return fail(flat.error());
  const auto parsed = toml::parse(toml, file);
  if (!parsed) {
    const auto at = parsed.error().source().begin;
    return fail(file_error(file, at.line, at.column, parsed.error().description()));
  }
  PdoFile out;
  std::int64_t format = 0;
  std::optional<Error> inner;
  const TableReader root(parsed.table(), file);
  const auto pdos = [&](const toml::node& node) {
    const auto* array = node.as_array();
    if (array == nullptr) return false;
    const auto read = read_recipes(*array, file, out.pdos);
    if (!read) inner = read.error();
    return read.has_value();
  };
  const auto done = root.read({{"format", [&](const auto& n) { return get_int(n, format) && format == 1; }},
                               {"family", into(out.family)},
                               {"pdo", pdos}});
  if (inner) return fail(*inner);
  if (!done) return fail(done.error());
  if (format == 0)
    return fail(Errc::file, message("{}: 'format' is missing", as_it_is(file)),
                "begin the file with format = 1");
  return out;
}

}  // namespace servoctl::drive
