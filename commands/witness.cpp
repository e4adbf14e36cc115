#include "trial/witness.hpp"
#include "base/format.hpp"

#include "base/file.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/provenance.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

constexpr Parameter kWitnessParameters[] = {
    {.name = "file", .help = "FILE.json, to be sent to the project", .kind = Kind::file, .required = true},
};

Result<Value> run_witness(Context& context, const Arguments& arguments) {
  const std::filesystem::path path(arguments.text("file"));
  if (lower(path.extension().string()) != ".json")
    return fail(Errc::usage, message("'{}': the file must end in .json", as_it_is(path.string())));
  if (context.nodes.size() != 1) return fail(Errc::usage, "one file is of one node", "say -n 1");
  const auto possible = check_writable(path);
  if (!possible) return fail(possible.error());
  const auto seen =
      trial::witness(context, context.nodes.front(), drive::find_families(context.drive_folders));
  if (!seen) return fail(seen.error());
  const auto document = trial::witness_document(context, *seen);
  if (const auto written = write_file_atomically(path, report::to_json(document) + "\n"); !written)
    return fail(written.error());
  if (seen->ended) context.errors.push_back(*seen->ended);
  context.notices.push_back(
      "the file has no value of a setting, no serial number, no node-ID and no name that you gave; read it before "
      "you send it");
  return Value(report::Record{
      {"node", context.nodes.front()},
      {"file", path.string()},
      {"family", context.profile->family},
      {"provenance", drive::provenance_text(*context.profile, context.chinese), Show::text,
       "data checked against"},
      {"answered", seen->answers.size() - seen->refused(), Show::everywhere, "objects answered"},
      {"refused", seen->refused(), Show::everywhere, "objects refused"},
      {"differences", seen->differences.size(), Show::everywhere, "differences from the data"}});
}

constexpr Example kWitnessExamples[] = {
    {"witness first-contact.json -n 1 -d gsd600", "what the drive showed, to be sent to the project"},
};

}  // namespace

extern const Command kWitness;
const Command kWitness{
    .path = "witness",
    .summary = "Write what a real drive showed, for the project to collect",
    .details =
        "Reads every object that the data of the family list as readable, and writes nothing to the drive. The "
        "file says: identity and firmware, whether they fit the family, each object with the size of its answer "
        "or its abort code, and where the drive differs from the data: refused, of another size, outside of its "
        "limits. It has no value of a setting, no serial number, no node-ID and no name. If a wrong access is "
        "an alarm on the drive, nothing is asked that the data do not list. A fault of the drive ends the tour. "
        "Most data come from manuals alone: `drives FAMILY` says what they were checked against.",
    .parameters = kWitnessParameters,
    .examples = kWitnessExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .run = run_witness,
    .one_file = "file",
};

}  // namespace servoctl::commands
