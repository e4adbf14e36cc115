#include "show/explanation.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/homing_method.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "report/catalogue.hpp"
#include "show/caution_text.hpp"
#include "show/explanation_parts.hpp"
#include "show/lead_words.hpp"
#include "show/object_records.hpp"
#include "show/parameter_search.hpp"
#include "show/printed_number.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

using report::Value;

Explanation of_entry(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                     bool chinese) {
  auto topic = topic_heading(
      profile.family, "object", drive::entry_name(object, entry),
      formatted("{}: {}", to_string(entry.address), entry.name),
      entry.name_zh.empty() ? std::string() : formatted("{}：{}", to_string(entry.address), entry.name_zh));
  topic.object = entry.address;
  return {std::move(topic), Found::object, {}, object_details(profile, object, entry, chinese)};
}

Explanation of_object(const drive::Profile& profile, const od::Object& object, bool chinese) {
  if (object.entries.size() == 1) return of_entry(profile, object, object.entries.front(), chinese);
  auto topic = topic_heading(
      profile.family, "object", od::identifier(object.name),
      formatted("0x{:04X}: {}", object.index, object.name),
      object.name_zh.empty() ? std::string() : formatted("0x{:04X}：{}", object.index, object.name_zh));
  topic.object = ObjectAddress{object.index, 0};
  report::Table table;
  for (const auto& entry : object.entries)
    add_object_row(table, object_record(profile, object, entry, chinese));
  explain_marks(table);
  return {std::move(topic), Found::object, {}, std::move(table)};
}

/// Whether the text names an entry, not the object it is of.
bool has_sub_index(std::string_view text) {
  return text.find_first_of(":.") != std::string_view::npos || lower(text).find("sub") != std::string::npos;
}

/// Of `6098h=7` the object stands behind what its value means.
void add_objects(const TopicQuery& query, const drive::Profile& profile, bool chinese,
                 std::vector<Explanation>& out) {
  const TopicQuery subject(query.subject());
  const auto address = parse_object_address(query.subject());
  const bool one = address && has_sub_index(query.subject());
  const auto add = [&](Explanation found) {
    if (query.has_value()) found.found = Found::row;
    out.push_back(std::move(found));
  };
  for (const auto& object : profile.dictionary.objects()) {
    const bool whole = address ? !one && object.index == address->index
                               : subject.names(object.name) || subject.names(object.name_zh);
    const bool is_parameter =
        object.entries.size() == 1 && profile.parameter(object.entries.front().address) != nullptr;
    if (whole && !is_parameter) add(of_object(profile, object, chinese));
    if (whole) continue;
    for (const auto& entry : object.entries) {
      const bool meant =
          address ? one && entry.address == *address
                  : subject.names(drive::entry_name(object, entry)) || subject.names(entry.name_zh);
      if (meant && profile.parameter(entry.address) == nullptr)
        add(of_entry(profile, object, entry, chinese));
    }
  }
}

bool is_all_parameters(const drive::Profile& profile, const od::Object& object) {
  return std::all_of(object.entries.begin(), object.entries.end(),
                     [&](const od::Entry& entry) { return profile.parameter(entry.address) != nullptr; });
}

/// Objects in whose names the words stand, else the entries.
void add_mentioning_objects(const TopicQuery& query, const drive::Profile& profile, bool chinese,
                            std::vector<Explanation>& out) {
  if (parse_object_address(query.subject())) return;
  const auto known = [&](ObjectAddress address) {
    return std::any_of(out.begin(), out.end(),
                       [&](const Explanation& each) { return each.topic.object == address; });
  };
  const auto add = [&](Explanation found) {
    if (known(*found.topic.object)) return;
    found.found = Found::title;
    out.push_back(std::move(found));
  };
  for (const auto& object : profile.dictionary.objects()) {
    if (is_all_parameters(profile, object)) continue;
    if (query.mentions(searchable({object.name, object.name_zh}))) {
      add(of_object(profile, object, chinese));
      continue;
    }
    for (const auto& entry : object.entries)
      if (profile.parameter(entry.address) == nullptr &&
          query.mentions(searchable({object.name + " " + entry.name, object.name_zh + entry.name_zh})))
        add(of_entry(profile, object, entry, chinese));
  }
}

/// What cautions of the family make of a motion goes behind the text of what they are about.
void add_cautions(const drive::Profile& profile, const std::function<bool(const drive::Caution&)>& concerns,
                  drive::Topic& topic) {
  for (const auto& caution : profile.rules.cautions) {
    if (!concerns(caution)) continue;
    append(topic.text, caution_text(profile, caution, false), "\n\n");
    append(topic.text_zh, caution_text(profile, caution, true), "\n\n");
  }
}

/// Whether the drive may be set so that this method of 6098h finds no home.
bool hinders(const drive::Profile& profile, const drive::Caution& caution, std::int64_t method) {
  const auto& blocked = caution.methods;
  if (std::find(blocked.begin(), blocked.end(), method) != blocked.end()) return true;
  const auto switches = drive::switches_of(profile.rules.motion, method);
  return std::any_of(switches.begin(), switches.end(),
                     [&](auto input) { return caution.masks_input(input); });
}

void add_parameters(const TopicQuery& query, const drive::Profile& profile, bool by_name_only, bool chinese,
                    std::vector<Explanation>& out) {
  const auto* by_id = profile.parameter(query.whole());
  const auto address = parse_object_address(query.whole());
  for (const auto& parameter : profile.parameters) {
    if (parameter.placed) continue;  // It is told as an object.
    const bool named = query.names(parameter.name) || query.names(parameter.name_zh);
    const bool placed = address && parameter.object == address;
    const bool meant = &parameter == by_id || (!by_name_only && (named || placed));
    const auto words = meant || by_name_only ? std::nullopt : words_in(query, parameter);
    if (!meant && !words) continue;
    auto topic =
        topic_heading(profile.family, "parameter", parameter.id, parameter.id + " " + parameter.name,
                      parameter.name_zh.empty() ? std::string() : parameter.id + " " + parameter.name_zh);
    topic.object = parameter.object;
    topic.line = source_of_line(parameter.line);
    add_cautions(
        profile, [&](const auto& caution) { return caution.name == parameter.id; }, topic);
    out.push_back({std::move(topic),
                   meant                     ? Found::parameter
                   : *words == WordsIn::name ? Found::title
                                             : Found::text,
                   {},
                   parameter_record(parameter, chinese)});
  }
}

void add_topics(const TopicQuery& query, const Library& library, std::vector<Explanation>& out) {
  for (const auto& topic : library.topics) {
    auto match =
        library.by_name_only ? query.match_name(topic) : query.match(topic, &library.profile->dictionary);
    if (!match) continue;
    out.push_back({topic, match->found, std::move(match->rows)});
    if (topic.object != objects::kHomingMethod || !topic.value) continue;
    const auto& profile = *library.profile;
    add_cautions(
        profile, [&](const auto& caution) { return hinders(profile, caution, *topic.value); },
        out.back().topic);
  }
}

/// For the family that was named, or the standard.
void add_number_of(const TopicQuery& query, std::span<const Library> libraries,
                   std::vector<Explanation>& out) {
  if (!libraries.empty() && !libraries.front().by_name_only)
    add_number(query, *libraries.front().profile, out);
}

std::vector<Explanation> explained(const TopicQuery& query, std::span<const Library> libraries,
                                   bool chinese) {
  std::vector<Explanation> out;
  for (const auto& library : libraries) {
    const auto& profile = *library.profile;
    if (!library.by_name_only) add_objects(query, profile, chinese, out);
    add_parameters(query, profile, library.by_name_only, chinese, out);
    add_faults(query, profile, library.by_name_only, chinese, out);
    add_topics(query, library, out);
    if (library.by_name_only) continue;
    add_mentioning_objects(query, profile, chinese, out);
    add_value(query, library, out);
  }
  if (!libraries.empty()) add_abort(query, *libraries.front().profile, out);
  add_exit_code(query, out);
  if (out.empty()) add_number_of(query, libraries, out);
  std::stable_sort(out.begin(), out.end(),
                   [](const Explanation& a, const Explanation& b) { return a.found < b.found; });
  return out;
}

}  // namespace

drive::Topic topic_heading(std::string_view family, std::string kind, std::string name, std::string title,
                           std::string title_zh) {
  drive::Topic out;
  out.family = family;
  out.kind = std::move(kind);
  out.name = std::move(name);
  out.title = std::move(title);
  out.title_zh = std::move(title_zh);
  return out;
}

std::string source_of_line(std::uint32_t line) { return line == 0 ? std::string() : formatted("{}", line); }

std::vector<Explanation> explanations(const TopicQuery& query, std::span<const Library> libraries,
                                      bool chinese) {
  auto out = explained(query, libraries, chinese);
  const auto led = without_lead(query.whole());
  if (!led || (!out.empty() && out.front().found < Found::row)) return out;
  auto behind = explained(query.of(led->rest), libraries, chinese);
  std::erase_if(behind, [&](const Explanation& each) { return each.found != led->found; });
  if (behind.empty() && led->found == Found::fault)
    for (const auto& library : libraries) add_counted_faults(led->rest, library, chinese, behind);
  constexpr std::size_t kDigits = 4;
  const auto code = led->rest.size() >= kDigits ? code_in(led->rest, kDigits) : std::nullopt;
  if (behind.empty() && out.empty() && led->found == Found::fault && code)
    add_number_of(query.of(formatted("0x{:04X}", *code)), libraries, out);
  out.insert(out.begin(), std::make_move_iterator(behind.begin()), std::make_move_iterator(behind.end()));
  return out;
}

std::string not_in_manual(const TopicQuery& query, const drive::Profile& profile) {
  if (query.thing() == nullptr || !query.thing()->absent) return {};
  return formatted("the manual of {} has nothing about '{}'", profile.family, query.whole());
}

std::vector<std::string> explained_names(std::span<const Library> libraries) {
  std::vector<std::string> out;
  for (const auto& library : libraries) {
    for (const auto& topic : library.topics) {
      out.push_back(topic.name);
      out.insert(out.end(), topic.also.begin(), topic.also.end());
    }
    if (library.by_name_only) continue;
    auto known = drive::names(*library.profile);
    out.insert(out.end(), std::make_move_iterator(known.begin()), std::make_move_iterator(known.end()));
    for (const auto& fault : library.profile->faults)
      if (!fault.panel.empty()) out.push_back(fault.panel);
  }
  return out;
}

}  // namespace servoctl::show
