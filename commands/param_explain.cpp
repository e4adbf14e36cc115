#include "command/command.hpp"
#include "drive/naming.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParamExplainParameters[] = {
    {.name = "id", .help = "panel number or name: Pn0202", .kind = Kind::parameter, .required = true},
};

Result<report::Value> run_param_explain(Context& context, const Arguments& arguments) {
  const auto parameter = drive::resolve_parameter(*context.profile, arguments.text("id"), drive::Match::part);
  if (!parameter) return fail(parameter.error());
  return report::Value(show::parameter_record(**parameter, context.chinese));
}

constexpr Example kParamExplainExamples[] = {
    {"param explain Pn0202 -d gsd600", "range, unit, default, labels, note and when it takes effect"},
};

}  // namespace

extern const Command kParamExplain;
const Command kParamExplain{
    .path = "param explain",
    .summary = "Show all that is known about a panel parameter",
    .details =
        "Works without a bus. What the manual does not state is marked assumed, what it states "
        "inconsistently contradicted.",
    .parameters = kParamExplainParameters,
    .examples = kParamExplainExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run_param_explain,
};

}  // namespace servoctl::commands
