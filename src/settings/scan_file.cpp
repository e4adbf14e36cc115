#include "settings/scan_file.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "settings/scan_ranges.hpp"

namespace servoctl::settings {
namespace {

constexpr std::string_view kTitle = "servoctl scan 2";
constexpr std::string_view kEnd = "end";
constexpr std::string_view kWriteOnly = "w";
constexpr std::string_view kRefused = "!";
std::optional<std::uint64_t> hexadecimal(std::string_view text, std::uint64_t most) {
  const auto number = parse_digits(text, 16);
  return number && *number <= most ? number : std::nullopt;
}

std::optional<Bytes> parse_bytes(std::string_view text) {
  Bytes out;
  if (text == "-") return out;
  if (text.size() % 2 != 0 || text.size() / 2 > session::kScannedBytes) return std::nullopt;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto byte = hexadecimal(text.substr(i, 2), 0xFF);
    if (!byte) return std::nullopt;
    out.push_back(static_cast<std::uint8_t>(*byte));
  }
  return out;
}

/// `6041:0 2 5002`, `2001:0 w`, `2002:0 ! 08000022`.
bool take_entry(const std::vector<std::string_view>& words, session::ScanState& state) {
  const auto object = words.size() < 2 ? std::nullopt : parse_object_address(words[0]);
  if (!object) return false;
  if (words.size() == 2 && words[1] == kWriteOnly) {
    state.entries.push_back({*object, false});
    return true;
  }
  if (words.size() != 3) return false;
  if (words[1] == kRefused) {
    const auto code = hexadecimal(words[2], 0xFFFF'FFFF);
    if (code) state.refusals.push_back({*object, static_cast<std::uint32_t>(*code)});
    return code.has_value();
  }
  const auto size = parse_digits(words[1], 10);
  auto bytes = parse_bytes(words[2]);
  if (!size || !bytes || bytes->size() != std::min<std::uint64_t>(*size, session::kScannedBytes))
    return false;
  state.entries.push_back({*object, true, *size, std::move(*bytes)});
  return true;
}

/// How many lines of objects the head announces.
struct Announced {
  std::optional<std::uint64_t> lines;
};

bool take_head(std::string_view key, std::string_view value, KeptScan& out, Announced& announced) {
  if (key == "drive") {
    out.identity = value;
    return true;
  }
  if (key == "ranges") {
    auto ranges = parse_ranges(value);
    if (ranges) out.state.ranges = std::move(*ranges);
    return ranges.has_value();
  }
  const auto number = parse_digits(value, 10);
  if (key == "lines") {
    announced.lines = number;
    return number.has_value();
  }
  if (key != "done" || !number || *number > out.state.indexes()) return false;
  out.state.done = *number;
  return true;
}

/// No object twice, and none of an index that is not done.
bool is_consistent(const session::ScanState& state) {
  std::set<std::uint16_t> done;
  for (std::size_t i = 0; i < state.done; ++i) done.insert(state.index_at(i));
  std::set<ObjectAddress> seen;
  const auto is_new = [&](const auto& each) {
    return done.contains(each.object.index) && seen.insert(each.object).second;
  };
  return std::all_of(state.entries.begin(), state.entries.end(), is_new) &&
         std::all_of(state.refusals.begin(), state.refusals.end(), is_new);
}

}  // namespace

std::filesystem::path scan_file(const std::filesystem::path& output) {
  auto out = output;
  out += ".part";
  return out;
}

std::string identity_text(std::string_view bus, const session::Identity& identity) {
  auto out = formatted("{} {}", bus, identity.node);
  for (const auto& number :
       {identity.device_type, identity.vendor_id, identity.product_code, identity.revision, identity.serial})
    out += number ? formatted(" {:08X}", *number) : std::string(" -");
  for (const auto* name : {&identity.device_name, &identity.hardware_version, &identity.software_version})
    out += formatted(" |{}", to_hex(Bytes(name->begin(), name->end()), ""));
  return out;
}

bool is_one_of_many(const session::Identity& identity) {
  return !identity.vendor_id || !identity.product_code || !identity.serial || *identity.serial == 0;
}

std::string scan_text(std::string_view identity, const session::ScanState& state) {
  auto out = formatted("{}\ndrive {}\nranges {}\ndone {}\nlines {}\n", kTitle, identity,
                       ranges_text(state.ranges), state.done, state.entries.size() + state.refusals.size());
  for (const auto& entry : state.entries) {
    const auto place = formatted("{:04X}:{:X}", entry.object.index, entry.object.sub);
    out += entry.readable ? formatted("{} {} {}\n", place, entry.size,
                                      entry.begin.empty() ? "-" : to_hex(entry.begin, ""))
                          : formatted("{} {}\n", place, kWriteOnly);
  }
  for (const auto& refusal : state.refusals)
    out += formatted("{:04X}:{:X} {} {:08X}\n", refusal.object.index, refusal.object.sub, kRefused,
                     refusal.abort_code);
  return out + formatted("{}\n", kEnd);
}

bool is_scan_file(std::string_view text) { return text.starts_with("servoctl scan "); }

std::optional<KeptScan> read_scan(std::string_view text) {
  constexpr std::size_t kHeadLines = 5;
  KeptScan out;
  Announced announced;
  auto lines = split(text, '\n');
  if (!lines.empty() && lines.back().empty()) lines.pop_back();
  if (lines.size() <= kHeadLines || lines.front() != kTitle || lines.back() != kEnd) return std::nullopt;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const auto line = lines[i];
    const auto blank = std::min(line.find(' '), line.size());
    const bool taken = i < kHeadLines
                           ? take_head(line.substr(0, blank), trim(line.substr(blank)), out, announced)
                           : take_entry(split(line, ' '), out.state);
    if (!taken) return std::nullopt;
  }
  const bool is_whole = !out.state.ranges.empty() && !out.identity.empty() &&
                        announced.lines == out.state.entries.size() + out.state.refusals.size();
  return is_whole && is_consistent(out.state) ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace servoctl::settings
