#include "pdo/pdo_source.hpp"

#include <map>
#include <optional>
#include <vector>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "od/data_sheet.hpp"
#include "pdo/pdo_recipes.hpp"
#include "session/pdo_setup.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::pdo {
namespace {

using session::Values;

/// An EDS or ESI is of no node: any node-ID does, as it is taken out again.
constexpr std::uint8_t kAnyNode = 127;

std::optional<std::uint16_t> list_of(const drive::Profile& profile, canopen::PdoDirection direction) {
  const auto list = session::assignment_of(&profile, direction);
  return list ? std::optional(list->index) : std::nullopt;
}

/// What a dictionary file gives the objects: the configured value of a DCF, else the default.
Values values_of_sheet(const drive::Profile& profile, const od::Dictionary& dictionary, std::uint8_t node) {
  Values out;
  const auto rpdos = list_of(profile, canopen::PdoDirection::receive);
  const auto tpdos = list_of(profile, canopen::PdoDirection::transmit);
  for (const auto& object : dictionary.objects())
    for (const auto& entry : object.entries) {
      const auto& value = entry.configured ? entry.configured : entry.default_value;
      const bool wanted =
          canopen::pdo_at(object.index).has_value() || object.index == rpdos || object.index == tpdos;
      if (!wanted || !value) continue;
      if (auto data = od::encode(entry.type, value->for_node(node)))
        out.emplace(entry.address, std::move(*data));
    }
  return out;
}

/// A list with its count in sub-index 0.
void put_list(Values& out, std::uint16_t index, const std::vector<std::uint32_t>& items, std::size_t size) {
  out.insert_or_assign({index, 0}, store_le(items.size(), 1));
  for (std::size_t i = 0; i < items.size(); ++i)
    out.insert_or_assign({index, static_cast<std::uint8_t>(i + 1)}, store_le(items[i], size));
}

/// The PDOs of an ESI go before what its dictionary says of them: they are what a master is to set up. Where
/// it gives none of them a sync manager it says nothing of which are assigned.
void add_layout(const drive::Profile& profile, const od::EsiLayout& layout, Values& out) {
  std::map<canopen::PdoDirection, std::vector<std::uint32_t>> assigned;
  for (const auto& pdo : layout.pdos) {
    if (!is_pdo_mapping(pdo.index)) continue;
    std::vector<std::uint32_t> entries;
    for (const auto& entry : pdo.entries)
      entries.push_back(std::uint32_t{entry.object.index} << 16U | std::uint32_t{entry.object.sub} << 8U |
                        entry.bits);
    put_list(out, pdo.index, entries, 4);
    if (pdo.sync_manager || pdo.mandatory) assigned[pdo.direction].push_back(pdo.index);
  }
  for (const auto& [direction, records] : assigned)
    if (const auto list = list_of(profile, direction)) put_list(out, *list, records, 2);
}

/// The PDOs of values that belong to one node, as recipes for any.
drive::PdoFile recipes_of(const drive::Profile& profile, std::string family, const Values& values,
                          std::uint8_t node) {
  drive::PdoFile out;
  out.family = std::move(family);
  const PresentPdos source{node, values, session::pdos_of(values)};
  for (const auto& pdo : source.pdos) out.pdos.push_back(recipe_of(&profile, source, pdo));
  return out;
}

Result<drive::PdoFile> from_backup(const drive::Profile& profile, const std::filesystem::path& file) {
  const auto backup = settings::read_backup(file);
  if (!backup) return fail(backup.error());
  Values values;
  for (const auto& entry : backup->entries)
    if (entry.bytes) values.emplace(entry.object, *entry.bytes);
  return recipes_of(profile, backup->family, values, backup->identity.node);
}

tl::unexpected<Error> has_errors(const std::string& file, std::size_t count) {
  return fail(Errc::file, message("{} has {} errors", as_it_is(file), count),
              message("`eds check {}` shows them", as_it_is(file)));
}

Result<drive::PdoFile> from_esi(const drive::Profile& profile, const std::string& word,
                                std::string_view text) {
  const auto name = od::sheet_name(word);
  const auto esi = od::read_esi(text, name.path, name.device);
  if (!esi) return fail(esi.error());
  if (esi->sheet.error_count() > 0) return has_errors(word, esi->sheet.error_count());
  auto values = values_of_sheet(profile, esi->sheet.dictionary, kAnyNode);
  add_layout(profile, esi->layout, values);
  return recipes_of(profile, {}, values, kAnyNode);
}

Result<drive::PdoFile> from_dictionary(const drive::Profile& profile, const std::filesystem::path& path) {
  const auto text = od::read_sheet_file(path.string());
  if (!text) return fail(text.error());
  if (od::is_xml(*text)) return from_esi(profile, path.string(), *text);
  const auto file = od::read_data_sheet(*text, path.string());
  if (!file) return fail(file.error());
  if (file->error_count() > 0) return has_errors(path.string(), file->error_count());
  const std::uint8_t node = file->node_id == 0 ? kAnyNode : file->node_id;
  return recipes_of(profile, {}, values_of_sheet(profile, file->dictionary, node), node);
}

Result<drive::PdoFile> read_any(const drive::Profile& profile, const std::filesystem::path& file) {
  const auto extension =
      lower(std::filesystem::path(od::sheet_name(file.string()).path).extension().string());
  if (extension == ".eds" || extension == ".dcf" || extension == ".xml")
    return from_dictionary(profile, file);
  if (extension == ".toml") return read_pdo_file(file);
  const auto text = read_file(file);
  if (!text) return fail(text.error());
  return text->find("\"servoctl_backup\"") != std::string::npos ? from_backup(profile, file)
                                                                : read_pdo_file(file);
}

}  // namespace

Result<drive::PdoFile> read_pdo_source(const drive::Profile& profile, const std::filesystem::path& file) {
  auto out = read_any(profile, file);
  if (!out) return out;
  if (out->pdos.empty()) return fail(Errc::negative, message("{} contains no PDOs", as_it_is(file.string())));
  if (!out->family.empty() && !equals_nocase(out->family, profile.family))
    return fail(Errc::refused,
                message("{} is for {}, not for {}", as_it_is(file.string()), as_it_is(out->family),
                        as_it_is(profile.family)),
                "edit a copy: remove the family, or set this one");
  return out;
}

}  // namespace servoctl::pdo
