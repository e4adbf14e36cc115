#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "show/explanation.hpp"
#include "show/object_records.hpp"
#include "show/parameter_search.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParamSearchParameters[] = {
    {.name = "word",
     .help = "one or more words, English or Chinese; all must occur",
     .kind = Kind::text,
     .required = true,
     .many = true},
};

Result<report::Value> run_param_search(Context& context, const Arguments& arguments) {
  const auto& profile = *context.profile;
  if (const auto any = show::check_parameters(profile); !any) return fail(any.error());
  std::string said;
  for (const auto& word : arguments.all("word")) append(said, word, " ");
  const auto everyday = drive::load_everyday_words(profile, context.drive_folders);
  if (!everyday) return fail(everyday.error());
  const show::TopicQuery query(said, *everyday);
  std::vector<std::pair<show::WordsIn, const od::Parameter*>> found;
  for (const auto& parameter : profile.parameters)
    if (const auto place = show::words_in(query, parameter)) found.emplace_back(*place, &parameter);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const od::Parameter*> best;
  for (const auto& entry : found) best.push_back(entry.second);
  if (!best.empty()) return report::Value(show::parameter_table(best, context.chinese));
  const auto absent = show::not_in_manual(query, profile);
  if (!absent.empty()) return fail(Errc::negative, absent);
  return fail(Errc::negative,
              message("no parameter of {} mentions '{}'", as_it_is(profile.family), as_it_is(said)),
              message("`explain {}` looks in objects, faults and topics as well", as_it_is(said)));
}

constexpr Example kParamSearchExamples[] = {
    {"param search inertia ratio -d gsd600", "both words in number, name, label or note"},
    {"param search gain -d gsd600 --lang zh", "with the Chinese names; Chinese words are found as well"},
};

}  // namespace

extern const Command kParamSearch;
const Command kParamSearch{
    .path = "param search",
    .summary = "Find panel parameters by words, in English or Chinese",
    .details =
        "Searches numbers, names, labels and notes; matches in the name come first. The words are understood as by "
        "`explain`. Works without a bus.",
    .parameters = kParamSearchParameters,
    .examples = kParamSearchExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run_param_search,
};

}  // namespace servoctl::commands
