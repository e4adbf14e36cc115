#include "canopen/node_list.hpp"

#include <algorithm>
#include <numeric>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::canopen {
namespace {

std::optional<std::uint64_t> parse_node_id(std::string_view text) {
  const auto number = parse_integer(trim(text));
  if (!number || number->negative || number->magnitude < kFirstNode || number->magnitude > kLastNode)
    return std::nullopt;
  return number->magnitude;
}

}  // namespace

std::vector<std::uint8_t> every_node_id() {
  std::vector<std::uint8_t> out(kLastNode);
  std::iota(out.begin(), out.end(), kFirstNode);
  return out;
}

Result<std::vector<std::uint8_t>> parse_node_ids(std::string_view text, std::string_view hint) {
  std::vector<std::uint8_t> out;
  for (const auto part : split(text, ',')) {
    const auto dash = part.find('-', 1);
    const auto first = parse_node_id(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : parse_node_id(part.substr(dash + 1));
    if (!first || !last || *first > *last)
      return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(part)), std::string(hint));
    for (auto node = *first; node <= *last; ++node) out.push_back(static_cast<std::uint8_t>(node));
  }
  if (out.empty())
    return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(text)), std::string(hint));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace servoctl::canopen
