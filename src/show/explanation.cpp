#include "show/explanation.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <optional>

#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "report/catalogue.hpp"
#include "show/fault_records.hpp"
#include "show/lead_words.hpp"
#include "show/object_records.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

using report::Value;

constexpr std::string_view kProgram = "servoctl";

drive::Topic heading(std::string_view family, std::string kind, std::string name, std::string title,
                     std::string title_zh) {
  drive::Topic out;
  out.family = family;
  out.kind = std::move(kind);
  out.name = std::move(name);
  out.title = std::move(title);
  out.title_zh = std::move(title_zh);
  return out;
}

/// The lines of the manual behind a line of a table.
std::string source_of_line(std::uint32_t line) { return line == 0 ? std::string() : fmt::format("{}", line); }

Explanation of_entry(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                     bool chinese) {
  auto topic = heading(
      profile.family, "object", drive::entry_name(object, entry),
      fmt::format("{}: {}", to_string(entry.address), entry.name),
      entry.name_zh.empty() ? std::string() : fmt::format("{}：{}", to_string(entry.address), entry.name_zh));
  topic.object = entry.address;
  return {std::move(topic), Found::object, {}, object_details(profile, object, entry, chinese)};
}

Explanation of_object(const drive::Profile& profile, const od::Object& object, bool chinese) {
  if (object.entries.size() == 1) return of_entry(profile, object, object.entries.front(), chinese);
  auto topic = heading(profile.family, "object", od::identifier(object.name),
                       fmt::format("0x{:04X}: {}", object.index, object.name), {});
  topic.object = ObjectAddress{object.index, 0};
  std::vector<report::Record> records;
  for (const auto& entry : object.entries)
    records.push_back(object_record(profile, object, entry, {}, chinese));
  return {std::move(topic), Found::object, {}, object_table(std::move(records))};
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
    const bool whole = address ? !one && object.index == address->index : subject.names(object.name);
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

void add_parameters(const TopicQuery& query, const drive::Profile& profile, bool by_name_only, bool chinese,
                    std::vector<Explanation>& out) {
  const auto* by_id = profile.parameter(query.whole());
  const auto address = parse_object_address(query.whole());
  for (const auto& parameter : profile.parameters) {
    const bool named = query.names(parameter.name) || query.names(parameter.name_zh);
    const bool placed = address && parameter.object == address;
    const bool meant = &parameter == by_id || (!by_name_only && (named || placed));
    if (!meant && (by_name_only || !query.mentions(parameter.name + "\n" + parameter.name_zh))) continue;
    auto topic = heading(profile.family, "parameter", parameter.id, parameter.id + " " + parameter.name,
                         parameter.name_zh.empty() ? std::string() : parameter.id + " " + parameter.name_zh);
    topic.object = parameter.object;
    topic.line = source_of_line(parameter.line);
    out.push_back({std::move(topic),
                   meant ? Found::parameter : Found::title,
                   {},
                   parameter_record(parameter, chinese)});
  }
}

/// The code of a fault: up to four hexadecimal digits, however it is marked as such.
std::optional<std::uint64_t> hex_in(std::string_view text, std::size_t most_digits) {
  auto digits = lower(text);
  if (digits.starts_with("0x"))
    digits.erase(0, 2);
  else if (digits.ends_with("h"))
    digits.pop_back();
  if (digits.size() > most_digits) return std::nullopt;
  return parse_digits(digits, 16);
}

Explanation of_faults(const drive::Profile& profile, const std::vector<const drive::Fault*>& faults,
                      bool chinese) {
  const auto& first = *faults.front();
  const auto code = first.code ? fmt::format("0x{:04X}", *first.code) : std::string();
  const auto name = !first.panel.empty() ? first.panel : code.empty() ? first.name : code;
  if (faults.size() == 1) {
    const auto title_zh = first.name_zh.empty() ? std::string() : name + " " + first.name_zh;
    auto topic = heading(profile.family, "fault", name, name + " " + first.name, title_zh);
    topic.line = source_of_line(first.line);
    return {std::move(topic), Found::fault, {}, fault_record(first, chinese)};
  }
  auto shared = fmt::format("{}: {} faults share this code", code, faults.size());
  auto shared_zh = report::in_chinese(shared);
  return {heading(profile.family, "fault", code, std::move(shared), std::move(shared_zh)),
          Found::fault,
          {},
          fault_table(faults, chinese)};
}

/// As people write what a panel shows: `AL09` for `AL.09`.
std::string without_signs(std::string_view panel) {
  std::string out(panel);
  std::erase_if(out, [](char c) { return c == '.' || c == '-'; });
  return out;
}

void add_faults(const TopicQuery& query, const drive::Profile& profile, bool by_name_only, bool chinese,
                std::vector<Explanation>& out) {
  constexpr std::size_t kDigits = 4;
  constexpr std::size_t kTellingCode = 3;
  const auto code =
      query.whole().size() < kDigits || by_name_only ? std::nullopt : hex_in(query.whole(), kDigits);
  std::vector<const drive::Fault*> of_code;
  std::vector<const drive::Fault*> named;
  for (const auto& fault : profile.faults) {
    const bool second = fault.extra.size() >= kTellingCode && query.names(fault.extra);
    const bool called = query.names(fault.panel) || query.names_display(fault.panel) || second ||
                        (!by_name_only && (query.names(fault.name) || query.names(fault.name_zh)));
    const bool of_its_code = !called && code && fault.code == code;
    if (called) named.push_back(&fault);
    if (of_its_code) of_code.push_back(&fault);
    if (!called && !of_its_code && !by_name_only && query.mentions(fault.name + "\n" + fault.name_zh)) {
      out.push_back(of_faults(profile, {&fault}, chinese));
      out.back().found = Found::title;
    }
  }
  if (named.empty())
    for (const auto& fault : profile.faults)
      if (!fault.panel.empty() && query.names(without_signs(fault.panel))) named.push_back(&fault);
  for (const auto* fault : named) out.push_back(of_faults(profile, {fault}, chinese));
  if (of_code.size() > kFewFaults) {
    out.push_back(of_faults(profile, of_code, chinese));
  } else {
    for (const auto* fault : of_code) out.push_back(of_faults(profile, {fault}, chinese));
  }
}

/// Eight hexadecimal digits: of a class that CiA 301 has, or one that the family's own words tell of.
void add_abort(const TopicQuery& query, const drive::Profile& profile, std::vector<Explanation>& out) {
  constexpr std::size_t kDigits = 8;
  const auto code = hex_in(query.whole(), kDigits);
  if (!code || query.whole().size() < kDigits) return;
  const auto number = static_cast<std::uint32_t>(*code);
  const auto error_class = number >> 24U;
  const bool own = profile.rules.abort_texts.count(number) > 0;
  if (!own && error_class != 0x05 && error_class != 0x06 && error_class != 0x08) return;
  const auto name = fmt::format("0x{:08X}", number);
  const std::string words_zh(report::chinese_word(abort_words(&profile, true, number)));
  const auto words = abort_words(&profile, false, number);
  constexpr std::string_view kTitle = "SDO abort code {}: {}";
  auto topic =
      heading(profile.family, "abort", name, fmt::format(kTitle, name, words),
              words_zh == words ? std::string()
                                : fmt::format(fmt::runtime(report::chinese_word(kTitle)), name, words_zh));
  topic.text = canopen::sdo_abort_hint(number);
  topic.text_zh = report::in_chinese(topic.text);
  topic.line = canopen::is_standard_sdo_abort(number) ? "CiA 301, 7.2.4.3.17" : "";
  out.push_back({std::move(topic), Found::abort});
}

void add_exit_code(const TopicQuery& query, std::vector<Explanation>& out) {
  auto topic = exit_code_topic();
  const auto match = query.match(topic, nullptr);
  if (!match || (match->found != Found::name && match->found != Found::row)) return;
  out.push_back({std::move(topic), Found::exit, match->rows});
}

void add_topics(const TopicQuery& query, const Library& library, std::vector<Explanation>& out) {
  for (const auto& topic : library.topics) {
    auto match =
        library.by_name_only ? query.match_name(topic) : query.match(topic, &library.profile->dictionary);
    if (!match) continue;
    out.push_back({topic, match->found, std::move(match->rows)});
  }
}

}  // namespace

namespace {

std::vector<Explanation> explained(const TopicQuery& query, std::span<const Library> libraries,
                                   bool chinese) {
  std::vector<Explanation> out;
  for (const auto& library : libraries) {
    const auto& profile = *library.profile;
    if (!library.by_name_only) add_objects(query, profile, chinese, out);
    add_parameters(query, profile, library.by_name_only, chinese, out);
    add_faults(query, profile, library.by_name_only, chinese, out);
    add_topics(query, library, out);
  }
  if (!libraries.empty()) add_abort(query, *libraries.front().profile, out);
  add_exit_code(query, out);
  std::stable_sort(out.begin(), out.end(),
                   [](const Explanation& a, const Explanation& b) { return a.found < b.found; });
  return out;
}

}  // namespace

std::vector<Explanation> explanations(const TopicQuery& query, std::span<const Library> libraries,
                                      bool chinese) {
  auto out = explained(query, libraries, chinese);
  const auto led = without_lead(query.whole());
  if (!led || (!out.empty() && out.front().found < Found::title)) return out;
  auto behind = explained(TopicQuery(led->rest), libraries, chinese);
  std::erase_if(behind, [&](const Explanation& each) { return each.found != led->found; });
  out.insert(out.begin(), std::make_move_iterator(behind.begin()), std::make_move_iterator(behind.end()));
  return out;
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

drive::Topic exit_code_topic() {
  const auto chinese = [](std::string_view english) { return std::string(report::chinese_word(english)); };
  constexpr std::string_view kTitle = "Exit codes of servoctl";
  constexpr std::string_view kCode = "exit code";
  auto out = heading(kProgram, "exit", "exit codes", std::string(kTitle), chinese(kTitle));
  out.also = {"exit", std::string(kCode), chinese(kCode)};
  out.columns = {std::string(kCode), "error.code"};
  out.columns_zh = {chinese(kCode), "error.code"};
  const auto row = [&](int code, std::string_view name, std::string_view text) {
    out.rows.push_back({{fmt::format("{}", code), std::string(name)}, std::string(text), chinese(text), {}});
  };
  const auto error = [&](Errc code, std::string_view text) {
    row(exit_code(code), servoctl::name(code), text);
  };
  row(0, "", "done");
  error(Errc::negative, "it ran, and the answer is no: a difference, a failed check, an incomplete result");
  error(Errc::usage, "the request itself is wrong; nothing was sent");
  error(Errc::bus, "the bus is missing, down or lost");
  error(Errc::timeout, "the node did not answer in time");
  error(Errc::sdo_abort, "the drive answered and refused");
  error(Errc::protocol, "the drive answered with something the protocol does not allow");
  error(Errc::file, "a file cannot be read, written or parsed");
  error(
      Errc::refused,
      "refused for safety: a confirmation is missing (--yes), --read-only forbids it, or the drive is not what "
      "-d says");
  error(Errc::bug, "a fault of servoctl itself");
  error(Errc::interrupted, "interrupted by Ctrl-C");
  return out;
}

}  // namespace servoctl::show
