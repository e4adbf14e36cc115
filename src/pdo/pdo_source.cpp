#include "pdo/pdo_source.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "od/data_sheet.hpp"
#include "pdo/pdo_recipes.hpp"
#include "session/pdo_setup.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::pdo {
namespace {

using session::Values;

/// What a dictionary file gives the objects: the configured value of a DCF, else the default.
Values values_of_sheet(const od::Dictionary& dictionary, std::uint8_t node) {
  Values out;
  for (const auto& object : dictionary.objects())
    for (const auto& entry : object.entries) {
      const auto& value = entry.configured ? entry.configured : entry.default_value;
      const bool wanted = canopen::pdo_at(object.index).has_value();
      if (!wanted || !value) continue;
      if (auto data = od::encode(entry.type, value->for_node(node)))
        out.emplace(entry.address, std::move(*data));
    }
  return out;
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

Result<drive::PdoFile> from_dictionary(const drive::Profile& profile, const std::filesystem::path& path) {
  const auto text = od::read_sheet_file(path.string());
  if (!text) return fail(text.error());
  const auto file = od::read_data_sheet(*text, path.string());
  if (!file) return fail(file.error());
  if (file->error_count() > 0)
    return fail(Errc::file, fmt::format("{} has {} errors", path.string(), file->error_count()),
                fmt::format("`eds check {}` shows them", path.string()));
  // An EDS or ESI is of no node: any node-ID does, as it is taken out again.
  const std::uint8_t node = file->node_id == 0 ? 127 : file->node_id;
  return recipes_of(profile, {}, values_of_sheet(file->dictionary, node), node);
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
  if (out->pdos.empty()) return fail(Errc::negative, fmt::format("{} contains no PDOs", file.string()));
  if (!out->family.empty() && !equals_nocase(out->family, profile.family))
    return fail(Errc::refused,
                fmt::format("{} is for {}, not for {}", file.string(), out->family, profile.family),
                "edit a copy: remove the family, or set this one");
  return out;
}

}  // namespace servoctl::pdo
