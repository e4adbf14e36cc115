#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/trial_options.hpp"
#include "trial/comm_trial.hpp"
#include "trial/verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kTestCommParameters[] = {
    {.name = "--count", .help = "reads to make (default 200)", .kind = Kind::number},
    {.name = "--longest", .help = "longest round trip that passes (default 100ms)", .kind = Kind::duration},
    kJunitOption,
};

Result<report::Value> run_test_comm(Context& context, const Arguments& arguments) {
  trial::CommTrial test;
  const auto count = count_option(arguments, "--count", 1, 1'000'000, test.count);
  if (!count) return fail(count.error());
  const auto longest = duration_option(arguments, "--longest");
  if (!longest) return fail(longest.error());
  test = {*count, longest->value_or(test.longest)};
  std::vector<report::TestResult> results;
  for (const auto node : context.nodes) {
    auto result = trial::test_communication(context, node, test);
    if (!result) return fail(result.error());
    results.push_back(std::move(*result));
  }
  return trial::verdicts(context, verdict_options(arguments), results);
}

constexpr Example kTestCommExamples[] = {
    {"test comm -n 1", "200 reads and the heartbeat; exit code 1 if it fails"},
    {"test comm --count 2000 --longest 20ms --junit comm.xml -n 1", "stricter, with a file for a CI"},
};

}  // namespace

extern const Command kTestComm;
const Command kTestComm{
    .path = "test comm",
    .summary = "Test the communication with a drive, with a verdict",
    .details =
        "Reads 1000h many times without retries, then listens to the heartbeat. Passes if no answer was lost "
        "or violated the protocol, none took longer than --longest, the heartbeat came at the period of "
        "1017h, and there was no emergency, no restart and no error report of the CAN controller. Exit code "
        "1 if it fails. On EtherCAT no frame may be lost instead: there is no heartbeat. Changes nothing and moves "
        "nothing.",
    .parameters = kTestCommParameters,
    .examples = kTestCommExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_test_comm,
    .one_file = "--junit",
};

}  // namespace servoctl::commands
