#include <algorithm>
#include <iterator>
#include <memory>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/shared_profile.hpp"
#include "drive/topic_scope.hpp"
#include "report/catalogue.hpp"
#include "show/explanation.hpp"
#include "show/topic_page.hpp"
#include "traffic/explained_frame.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using show::Explanation;
using show::Found;

constexpr Parameter kExplainParameters[] = {
    {.name = "word",
     .help = "a name, a code, or words in English or Chinese; nothing: the topics by kind",
     .kind = Kind::topic,
     .many = true},
};

/// Families that were loaded to look something up, and what they know.
struct Shelf {
  std::vector<std::shared_ptr<const drive::Profile>> profiles;
  std::vector<show::Library> libraries;
  std::vector<drive::EverydayWords> everyday;
};

/// What the program knows by itself it tells itself.
void leave_out_own(std::vector<drive::Topic>& topics) {
  for (const auto name : {show::kExitCodes, show::kAlStatusCodes})
    std::erase_if(topics,
                  [&](const drive::Topic& topic) { return show::TopicQuery(name).names(topic.name); });
}

/// The family that the line names; else the standard, and of all families what has the very name.
Result<Shelf> open_shelf(Context& context) {
  Shelf out;
  if (context.profile != nullptr) {
    auto topics = drive::load_topics(*context.profile, context.drive_folders);
    if (!topics) return fail(topics.error());
    leave_out_own(*topics);
    auto own = std::vector{show::al_status_topic()};
    drive::remove_foreign_topics(own, *context.profile);
    auto everyday = drive::load_everyday_words(*context.profile, context.drive_folders);
    if (!everyday) return fail(everyday.error());
    out.everyday = std::move(*everyday);
    std::move(own.begin(), own.end(), std::back_inserter(*topics));
    out.libraries.push_back({context.profile, std::move(*topics), false});
    return out;
  }
  for (const auto& family : drive::find_families(context.drive_folders)) {
    auto profile = drive::shared_profile(family.name, context.drive_folders);
    auto topics = profile ? drive::load_own_topics(**profile) : Result<std::vector<drive::Topic>>();
    if (!profile || !topics) {
      context.notices.push_back(
          message("{}; {} is left out", (profile ? topics.error() : profile.error()).message, family.name));
      continue;
    }
    leave_out_own(*topics);
    const bool standard = (*profile)->is_generic();
    if (standard) topics->push_back(show::al_status_topic());
    if (auto everyday = standard ? drive::load_everyday_words(**profile, context.drive_folders)
                                 : Result<std::vector<drive::EverydayWords>>()) {
      std::move(everyday->begin(), everyday->end(), std::back_inserter(out.everyday));
    } else {
      context.notices.push_back(everyday.error().message);
    }
    out.profiles.push_back(std::move(*profile));
    show::Library library{out.profiles.back().get(), std::move(*topics), !standard};
    out.libraries.insert(standard ? out.libraries.begin() : out.libraries.end(), std::move(library));
  }
  return out;
}

/// In text what is laid out, in JSON the records.
report::Value answer(std::vector<std::string> lines, std::span<const Explanation> all) {
  report::Table out;
  out.below = std::move(lines);
  out.below_told = true;
  for (const auto& each : all) out.documents.emplace_back(show::explanation_record(each));
  return out;
}

/// Columns that pages are laid out in.
std::size_t page_width(const Context& context) {
  constexpr std::size_t kNoTerminal = 80;
  const auto terminal = context.audience == nullptr ? 0 : context.audience->width();
  return terminal == 0 ? kNoTerminal : std::clamp<std::size_t>(terminal, 40, 100);
}

/// So many topics are told in full although only words in them fit; more are listed.
constexpr std::size_t kFewTopics = 3;

/// How many come before the first that was found by this, or by less.
std::size_t count_before(std::span<const Explanation> all, Found found) {
  const auto end =
      std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.found >= found; });
  return static_cast<std::size_t>(end - all.begin());
}

/// What is called so is told in full; without such a thing rows in which the words stand. What else mentions
/// them is listed, of several families with the names of these.
report::Value told(const Context& context, std::span<const Explanation> all, bool families) {
  const auto width = page_width(context);
  const auto called = count_before(all, Found::row);
  const auto fitting = called > 0 ? called : count_before(all, Found::title);
  const auto in_full = fitting == 0 && all.size() <= kFewTopics ? all.size() : fitting;
  std::vector<std::string> lines;
  const auto rule = [&] {
    if (lines.empty()) return;
    lines.insert(lines.end(), {"", std::string(width, '-'), ""});
  };
  for (const auto& each : all.first(in_full)) {
    rule();
    auto page = show::topic_page(each, context.chinese, width);
    lines.insert(lines.end(), std::make_move_iterator(page.begin()), std::make_move_iterator(page.end()));
  }
  if (in_full < all.size()) {
    rule();
    constexpr std::string_view kMentions = "topics that mention it, for `explain NAME`:";
    if (in_full > 0)
      lines.insert(lines.end(),
                   {std::string(context.chinese ? report::chinese_word(kMentions) : kMentions), ""});
    auto list = in_full > 0 ? show::topic_names(all.subspan(in_full), context.chinese, width)
                            : show::topic_list(all.subspan(in_full), context.chinese, width, families);
    lines.insert(lines.end(), std::make_move_iterator(list.begin()), std::make_move_iterator(list.end()));
  }
  return answer(std::move(lines), all);
}

/// The topics of the family, or of the standard, by kind.
Result<report::Value> all_topics(const Context& context, const Shelf& shelf) {
  std::vector<Explanation> all;
  for (const auto& library : shelf.libraries)
    for (const auto& topic : library.topics)
      if (!library.by_name_only) all.push_back({topic, Found::name});
  all.push_back({show::exit_code_topic(), Found::name});
  const auto kinds = drive::topic_kinds();
  const auto place = [&](const Explanation& each) {
    return std::find(kinds.begin(), kinds.end(), each.topic.kind) - kinds.begin();
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Explanation& a, const Explanation& b) { return place(a) < place(b); });
  return answer(show::topic_list(all, context.chinese, page_width(context)), all);
}

/// Whether the standard has something of this name, which the family's data exclude: nothing was found, or
/// only texts and rows in which the words stand. Of what people have many names for, a text tells enough.
bool is_of_the_standard_alone(const Context& context, const show::TopicQuery& query,
                              std::span<const Explanation> found) {
  if (context.profile == nullptr || context.profile->is_generic()) return false;
  if (!found.empty() && (found.front().found < Found::row || query.thing() != nullptr)) return false;
  const auto standard = drive::shared_profile(drive::kStandardFamily, context.drive_folders);
  auto topics = standard ? drive::load_own_topics(**standard) : Result<std::vector<drive::Topic>>();
  if (!standard || !topics) return false;
  topics->push_back(show::al_status_topic());
  const std::vector<show::Library> shelf{{standard->get(), std::move(*topics), false}};
  const auto standards = show::explanations(show::TopicQuery(query.whole()), shelf, false);
  return !standards.empty() && standards.front().found < Found::row;
}

tl::unexpected<Error> no_entry_found(const Context& context, const Shelf& shelf,
                                     const show::TopicQuery& query) {
  const std::string_view said = query.whole();
  const auto family = context.profile == nullptr ? std::string() : context.profile->family;
  auto hint = did_you_mean(said, show::explained_names(shelf.libraries));
  if (hint.empty())
    hint =
        family.empty() ? "`explain` lists the topics of the standard, `explain -d FAMILY` those of a family"
        : context.profile->parameters.empty()
            ? "`explain` lists the topics; `fault list` looks for words in faults"
            : "`explain` lists the topics; `param search WORD` and `fault list` look for words in parameters and faults";
  return fail(Errc::negative,
              family.empty()
                  ? message("nothing is called '{}' or mentions it", as_it_is(said))
                  : message("nothing of {} is called '{}' or mentions it", as_it_is(family), as_it_is(said)),
              std::move(hint));
}

/// What the family's manual lacks, and the standard has all the same.
void note_absent(Context& context, const show::TopicQuery& query) {
  if (context.profile == nullptr) return;
  if (auto absent = show::not_in_manual(query, *context.profile); !absent.empty())
    context.notices.push_back(std::move(absent));
}

Result<report::Value> run_explain(Context& context, const Arguments& arguments) {
  std::string said;
  for (const auto& word : arguments.all("word")) append(said, word, " ");
  auto shelf = open_shelf(context);
  if (!shelf) return fail(shelf.error());
  if (trim(said).empty()) return all_topics(context, *shelf);
  if (const auto frame = traffic::explained_frame(said, *shelf->libraries.front().profile))
    return told(context, std::span(&*frame, 1), false);
  const show::TopicQuery query(said, shelf->everyday);
  auto all = show::explanations(query, shelf->libraries, context.chinese);
  const bool in_families = context.profile == nullptr && (all.empty() || all.front().found == Found::text);
  if (in_families) {
    for (auto& library : shelf->libraries) library.by_name_only = false;
    all = show::explanations(query, shelf->libraries, context.chinese);
  }
  if (all.empty() && context.profile != nullptr)
    if (auto absent = show::not_in_manual(query, *context.profile); !absent.empty())
      return fail(Errc::negative, std::move(absent));
  if (is_of_the_standard_alone(context, query, all))
    return fail(
        Errc::negative,
        message("not on this drive: {} has no '{}'", as_it_is(context.profile->family), as_it_is(said)),
        message("`explain {}` without -d shows the meaning in the standard", as_it_is(said)));
  if (all.empty()) return no_entry_found(context, *shelf, query);
  note_absent(context, query);
  return told(context, all, in_families);
}

constexpr Example kExplainExamples[] = {
    {"explain AL.03", "a fault as the panel shows it: what it is and what to do"},
    {"explain homing 17", "a homing method, with a picture"},
    {"explain statusword 0x1288", "what a value of an object means"},
};

}  // namespace

extern const Command kExplain;
const Command kExplain{
    .path = "explain",
    .summary = "Say what a word means: object, fault, code, plug, LED, mode, homing method",
    .details =
        "Works without a bus. Knows objects, panel parameters, faults, SDO abort codes, exit codes (`explain "
        "exit 5`), AL status codes of EtherCAT (`explain 0x001B`), and the topics of the manuals: wiring, plugs, "
        "panel, LEDs, states, modes, homing methods (`explain homing 7`), bits, inputs and outputs (`explain DI "
        "28`). A number is that of a row as it is printed, a hexadecimal one with 0x, h or neither. Explains "
        "a value of an object (`explain 6041h=0x0637`), a number alone (`explain 4744`) and a CAN frame (`explain "
        "581#8002650000000206`). Words that are no name are looked for in names, titles and texts, in any order; of "
        "many things the everyday names are known (`explain multi-turn reset`). Without -d the standard and what has this very name in "
        "any family, else the words in all families; without a word the topics by kind. --lang zh takes the Chinese texts.",
    .parameters = kExplainParameters,
    .examples = kExplainExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_explain,
};

}  // namespace servoctl::commands
