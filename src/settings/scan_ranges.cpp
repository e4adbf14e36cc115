#include "settings/scan_ranges.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::settings {
namespace {

constexpr std::size_t kMostRanges = 16;
constexpr std::string_view kHowWritten =
    "write them in hexadecimal, from 1000 to 9FFF: --range 2000-2FFF,6000-67FF";

/// `2000`, `0x2000`, `2000h`.
std::optional<std::uint64_t> index_of(std::string_view text) {
  constexpr std::uint64_t kLast = 0x9FFF;
  if (text.starts_with("0x") || text.starts_with("0X"))
    text.remove_prefix(2);
  else if (text.ends_with('h') || text.ends_with('H'))
    text.remove_suffix(1);
  const auto number = parse_digits(text, 16);
  return number && *number <= kLast ? number : std::nullopt;
}

std::optional<session::IndexRange> parse_range(std::string_view text) {
  const auto dash = std::min(text.find('-'), text.size());
  const auto first = index_of(trim(text.substr(0, dash)));
  const auto last = dash == text.size() ? first : index_of(trim(text.substr(dash + 1)));
  if (!first || !last || *first < 0x1000 || *last < *first) return std::nullopt;
  return session::IndexRange{static_cast<std::uint16_t>(*first), static_cast<std::uint16_t>(*last)};
}

}  // namespace

std::vector<session::IndexRange> ranges_of_axes(std::span<const ObjectAddress> statuswords) {
  std::vector<session::IndexRange> out{{0x1000, 0x67FF}};
  for (unsigned axis = 2; axis <= drive::kMostAxes; ++axis) {
    const auto statusword = drive::of_axis(objects::kStatusword, axis);
    if (std::find(statuswords.begin(), statuswords.end(), statusword) == statuswords.end()) continue;
    const auto first = drive::of_axis({0x6000, 0}, axis).index;
    const auto last = drive::of_axis({0x67FF, 0}, axis).index;
    if (out.back().last + 1 == first)
      out.back().last = last;
    else
      out.push_back({first, last});
  }
  return out;
}

Result<std::vector<session::IndexRange>> parse_ranges(std::string_view text) {
  std::vector<session::IndexRange> out;
  const auto parts = split(text, ',');
  if (parts.size() > kMostRanges)
    return fail(Errc::usage,
                message("--range names {} ranges, and at most {} are possible", parts.size(), kMostRanges));
  for (const auto part : parts) {
    if (trim(part).empty() && parts.size() > 1)
      return fail(Errc::usage, message("'{}': a range is missing beside a comma", as_it_is(text)),
                  std::string(kHowWritten));
    const auto range = parse_range(trim(part));
    if (!range)
      return fail(Errc::usage, message("'{}' is no range of indexes", as_it_is(part)),
                  std::string(kHowWritten));
    for (const auto& other : out)
      if (range->first <= other.last && other.first <= range->last)
        return fail(Errc::usage, message("'{}': an index would be scanned twice", as_it_is(part)));
    out.push_back(*range);
  }
  if (out.empty()) return fail(Errc::usage, "--range names no indexes", std::string(kHowWritten));
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return out;
}

std::string ranges_text(const std::vector<session::IndexRange>& ranges) {
  std::string out;
  for (const auto& range : ranges) append(out, formatted("{:04X}-{:04X}", range.first, range.last), ",");
  return out;
}

std::string unread_text(const session::ScanState& state) {
  constexpr std::size_t kMostParts = 8;
  std::set<std::uint16_t> indexes;
  for (const auto& refusal : state.refusals) indexes.insert(refusal.object.index);
  std::vector<session::IndexRange> out;
  for (const auto index : indexes) {
    if (!out.empty() && out.back().last + 1 == index)
      out.back().last = index;
    else
      out.push_back({index, index});
  }
  return out.size() > kMostParts ? formatted("{} of them", indexes.size()) : ranges_text(out);
}

}  // namespace servoctl::settings
