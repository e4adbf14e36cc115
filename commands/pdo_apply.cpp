
#include "base/format.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "pdo/pdo_recipes.hpp"
#include "pdo/pdo_source.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kPdoApplyParameters[] = {
    {.name = "file",
     .help = "pdos.toml or .json of `pdo save`, a backup, an .eds, .dcf or .xml",
     .kind = Kind::file,
     .required = true},
    kKeepOption,
    kUnlockOption,
};

Result<drive::PdoFile> fitting(const Context& context, const Arguments& arguments) {
  return pdo::read_pdo_source(*context.profile, std::filesystem::path(arguments.text("file")));
}

Result<void> check_pdo_apply(Context& context, const Arguments& arguments) {
  if (const auto file = fitting(context, arguments); !file) return fail(file.error());
  return {};
}

Result<report::Value> run_pdo_apply(Context& context, const Arguments& arguments) {
  const auto file = fitting(context, arguments);
  if (!file) return fail(file.error());
  const pdo::PdoEdit edit = [&](const pdo::PresentPdos& present) -> Result<pdo::WantedPdos> {
    auto wanted = pdo::follow(*context.profile, present, file->pdos);
    if (wanted) return wanted;
    auto error = wanted.error();
    error.message = message("{}{}: {}", as_it_is(arguments.text("file")),
                            error.line ? message(":{}", *error.line) : std::string(), error.message);
    return fail(std::move(error));
  };
  return pdo::change_pdos(
      context, edit,
      {.keep = arguments.has("--keep"), .unlock = arguments.has("--unlock"), .file = arguments.text("file")});
}

constexpr Example kPdoApplyExamples[] = {
    {"pdo apply pdos.toml --dry-run -n 1 -d gsd600", "first: show the frames"},
    {"pdo apply pdos.toml --keep -n 1 -d gsd600", "all PDOs of the file, kept over power-off"},
};

}  // namespace

extern const Command kPdoApply;
const Command kPdoApply{
    .path = "pdo apply",
    .summary = "Write the PDOs of a file to a drive",
    .details =
        "All PDOs of the file are written, or none. The file may come from `pdo save`, or be a backup of the "
        "same family, an EDS, a DCF or an ESI. CAN-IDs that contain the node-ID follow the node. PDOs not in the "
        "file stay unchanged.",
    .parameters = kPdoApplyParameters,
    .examples = kPdoApplyExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run_pdo_apply,
    .check = check_pdo_apply,
};

}  // namespace servoctl::commands
