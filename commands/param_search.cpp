#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "show/object_records.hpp"
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

/// How well the parameter fits one word: 0 in its number or name, 1 in a label, 2 in the note, 3 not at all.
int rank(const od::Parameter& p, std::string_view word) {
  if (show::contains_nocase(p.id, word) || show::contains_nocase(p.name, word) ||
      show::contains_nocase(p.name_zh, word))
    return 0;
  for (const auto& label : p.labels)
    if (show::contains_nocase(label.label, word) || show::contains_nocase(label.label_zh, word)) return 1;
  return show::contains_nocase(p.note, word) || show::contains_nocase(p.note_zh, word) ? 2 : 3;
}

Result<report::Value> run_param_search(Context& context, const Arguments& arguments) {
  if (const auto any = show::check_parameters(*context.profile); !any) return fail(any.error());
  std::vector<std::pair<int, const od::Parameter*>> found;
  std::string said;
  for (const auto& word : arguments.all("word")) append(said, word, " ");
  for (const auto& parameter : context.profile->parameters) {
    int worst = 0;
    for (const auto& word : arguments.all("word")) worst = std::max(worst, rank(parameter, word));
    if (worst < 3) found.emplace_back(worst, &parameter);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const od::Parameter*> best;
  for (const auto& entry : found) best.push_back(entry.second);
  if (best.empty())
    return fail(Errc::negative, formatted("no parameter of {} mentions '{}'", context.profile->family, said),
                "try a shorter word, or the Chinese or English one");
  return report::Value(show::parameter_table(best, context.chinese));
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
        "Searches numbers, names, labels and notes; matches in the name come first. Works without a bus.",
    .parameters = kParamSearchParameters,
    .examples = kParamSearchExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run_param_search,
};

}  // namespace servoctl::commands
