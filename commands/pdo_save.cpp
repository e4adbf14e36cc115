
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "pdo/pdo_recipes.hpp"
#include "session/pdo_setup.hpp"
#include "show/pdo_report.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kPdoSaveParameters[] = {
    {.name = "file", .help = "pdos.toml or pdos.json", .kind = Kind::file, .required = true},
};

Result<report::Value> run_pdo_save(Context& context, const Arguments& arguments) {
  const std::filesystem::path path(arguments.text("file"));
  const auto extension = lower(path.extension().string());
  if (extension != ".toml" && extension != ".json")
    return fail(Errc::usage, message("'{}': a PDO file must end in .toml or .json", as_it_is(path.string())));
  if (context.nodes.size() != 1) return fail(Errc::usage, "one file takes the PDOs of one node", "say -n 1");
  const auto node = context.nodes.front();
  const auto read = session::read_pdo_values(*context.session, context.profile, context.nodes).front();
  if (!read) return fail(read.error());
  const pdo::PresentPdos present{node, *read, session::pdos_of(*read)};
  const auto [file, names] = pdo::saved_pdos(context, present);
  const auto text = extension == ".json" ? pdo::pdo_json(file) : pdo::pdo_toml(file, names);
  if (!context.dry_run)
    if (const auto written = write_file_atomically(path, text); !written) return fail(written.error());
  return report::Value(report::Record{
      {"node", node}, {"file", path.string()}, {"pdos", file.pdos.size(), report::Show::everywhere, "PDOs"}});
}

constexpr Example kPdoSaveExamples[] = {
    {"pdo save pdos.toml -n 1 -d gsd600", "to read, to edit, and for `pdo apply`"},
};

}  // namespace

extern const Command kPdoSave;
const Command kPdoSave{
    .path = "pdo save",
    .summary = "Save the PDOs of a drive to a file",
    .details =
        "TOML, to read and edit, or JSON, by the extension. CAN-IDs that contain the node-ID are written "
        "with $NODEID, so that the file fits other nodes. `pdo apply` writes it to a drive.",
    .parameters = kPdoSaveParameters,
    .examples = kPdoSaveExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_pdo_save,
    .one_file = "file",
};

}  // namespace servoctl::commands
