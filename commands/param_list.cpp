#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "command/command.hpp"
#include "drive/parameter_ids.hpp"
#include "report/catalogue.hpp"
#include "show/object_records.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParamListParameters[] = {
    {.name = "pattern", .help = "a group (gain, terminal), a number with * (Pn02*)", .kind = Kind::text},
};

Result<report::Value> run_param_list(Context& context, const Arguments& arguments) {
  if (const auto any = show::check_parameters(*context.profile); !any) return fail(any.error());
  const auto pattern = arguments.text("pattern");
  std::vector<const od::Parameter*> found;
  std::vector<std::string> groups;
  const bool in_chinese = has_chinese(pattern);  // The catalogue is read for these alone.
  for (const auto& parameter : context.profile->parameters) {
    if (!parameter.group.empty() && std::find(groups.begin(), groups.end(), parameter.group) == groups.end())
      groups.push_back(parameter.group);
    if (pattern.empty() || equals_nocase(parameter.group, pattern) ||
        (in_chinese && report::chinese_word(parameter.group) == pattern) ||
        show::fits(pattern, parameter.id) ||
        drive::canonical_id(parameter.id) == drive::canonical_id(pattern))
      found.push_back(&parameter);
  }
  if (found.empty()) {
    if (context.chinese)
      for (auto& group : groups) group = report::chinese_word(group);
    return fail(
        Errc::negative,
        message("no parameter of {} matches '{}'", as_it_is(context.profile->family), as_it_is(pattern)),
        groups.empty() ? std::string("`param search WORD` looks for words in names")
                       : message("groups: {}; `param search WORD` looks for words in names", one_of(groups)));
  }
  return report::Value(show::parameter_table(found, context.chinese));
}

constexpr Example kParamListExamples[] = {
    {"param list -d gsd600", "all of the family"},
    {"param list gain -d gsd600", "a group"},
    {"param list 'Pn02*' -d gsd600", "those whose number begins so"},
};

}  // namespace

extern const Command kParamList;
const Command kParamList{
    .path = "param list",
    .summary = "List the panel parameters of a drive family",
    .details =
        "Works without a bus. Range and default are the numbers the panel shows; the unit column gives the "
        "size of one step. `?` marks what the manual does not state, `!` what it states inconsistently; "
        "`param explain` shows which, with line numbers.",
    .parameters = kParamListParameters,
    .examples = kParamListExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run_param_list,
};

}  // namespace servoctl::commands
