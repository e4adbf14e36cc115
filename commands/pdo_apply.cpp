#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "od/data_sheet.hpp"
#include "pdo/pdo_recipes.hpp"
#include "session/pdo_setup.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using session::Values;

constexpr Parameter kParameters[] = {
    {.name = "file",
     .help = "pdos.toml or .json of `pdo save`, a backup, an .eds, .dcf or .xml",
     .kind = Kind::file,
     .required = true},
    kKeepOption,
    kUnlockOption,
};

/// What a dictionary file gives the objects: the configured value of a DCF, else the default.
Values values_of(const od::Dictionary& dictionary, std::uint8_t node) {
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
drive::PdoFile recipes_of(const drive::Profile* profile, std::string family, const Values& values,
                          std::uint8_t node) {
  drive::PdoFile out;
  out.family = std::move(family);
  const pdo::PresentPdos source{node, values, session::pdos_of(values)};
  for (const auto& pdo : source.pdos) out.pdos.push_back(pdo::recipe_of(profile, source, pdo));
  return out;
}

Result<drive::PdoFile> from_backup(const Context& context, const std::filesystem::path& path) {
  const auto backup = settings::read_backup(path);
  if (!backup) return fail(backup.error());
  Values values;
  for (const auto& entry : backup->entries)
    if (entry.bytes) values.emplace(entry.object, *entry.bytes);
  return recipes_of(context.profile, backup->family, values, backup->identity.node);
}

Result<drive::PdoFile> from_dictionary(const Context& context, const std::filesystem::path& path) {
  const auto text = od::read_sheet_file(path.string());
  if (!text) return fail(text.error());
  const auto file = od::read_data_sheet(*text, path.string());
  if (!file) return fail(file.error());
  if (file->error_count() > 0)
    return fail(Errc::file, fmt::format("{} has {} errors", path.string(), file->error_count()),
                fmt::format("`eds check {}` shows them", path.string()));
  // An EDS or ESI is of no node: any node-ID does, as it is taken out again.
  const std::uint8_t node = file->node_id == 0 ? 127 : file->node_id;
  return recipes_of(context.profile, {}, values_of(file->dictionary, node), node);
}

Result<drive::PdoFile> read(const Context& context, const std::filesystem::path& path) {
  const auto extension =
      lower(std::filesystem::path(od::sheet_name(path.string()).path).extension().string());
  if (extension == ".eds" || extension == ".dcf" || extension == ".xml")
    return from_dictionary(context, path);
  if (extension == ".toml") return pdo::read_pdo_file(path);
  const auto text = read_file(path);
  if (!text) return fail(text.error());
  return text->find("\"servoctl_backup\"") != std::string::npos ? from_backup(context, path)
                                                                : pdo::read_pdo_file(path);
}

Result<drive::PdoFile> fitting(const Context& context, const Arguments& arguments) {
  const std::filesystem::path path(arguments.text("file"));
  auto file = read(context, path);
  if (!file) return file;
  if (file->pdos.empty()) return fail(Errc::negative, fmt::format("{} contains no PDOs", path.string()));
  if (!file->family.empty() && !equals_nocase(file->family, context.profile->family))
    return fail(Errc::refused,
                fmt::format("{} is for {}, not for {}", path.string(), file->family, context.profile->family),
                "edit a copy: remove the family, or set this one");
  return file;
}

Result<void> check(Context& context, const Arguments& arguments) {
  if (const auto file = fitting(context, arguments); !file) return fail(file.error());
  return {};
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  const auto file = fitting(context, arguments);
  if (!file) return fail(file.error());
  const pdo::PdoEdit edit = [&](const pdo::PresentPdos& present) -> Result<pdo::WantedPdos> {
    auto wanted = pdo::follow(*context.profile, present, file->pdos);
    if (wanted) return wanted;
    auto error = wanted.error();
    error.message = fmt::format("{}{}: {}", arguments.text("file"),
                                error.line ? fmt::format(":{}", *error.line) : std::string(), error.message);
    return fail(std::move(error));
  };
  return pdo::change_pdos(
      context, edit,
      {.keep = arguments.has("--keep"), .unlock = arguments.has("--unlock"), .file = arguments.text("file")});
}

}  // namespace

extern const Command kPdoApply;
const Command kPdoApply{
    .path = "pdo apply",
    .summary = "Write the PDOs of a file to a drive",
    .details =
        "All PDOs of the file are written, or none. The file may come from `pdo save`, or be a backup of the "
        "same family, an EDS, a DCF or an ESI. CAN-IDs that contain the node-ID follow the node. PDOs not in the "
        "file stay unchanged.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run,
    .check = check,
};

}  // namespace servoctl::commands
