#include "gateway/request.hpp"

#include <array>
#include <limits>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::gateway {
namespace {

struct Spelling {
  std::string_view verb;
  std::string_view what;  ///< The second word; empty: any, or none.
  Service service;
};

constexpr std::array kSpellings{
    Spelling{"r", "", Service::read},
    Spelling{"read", "", Service::read},
    Spelling{"w", "", Service::write},
    Spelling{"write", "", Service::write},
    Spelling{"start", "", Service::start},
    Spelling{"stop", "", Service::stop},
    Spelling{"preop", "", Service::preop},
    Spelling{"preoperational", "", Service::preop},
    Spelling{"reset", "node", Service::reset_node},
    Spelling{"reset", "comm", Service::reset_communication},
    Spelling{"reset", "communication", Service::reset_communication},
    Spelling{"set", "", Service::set},
    Spelling{"info", "", Service::info},
    Spelling{"help", "", Service::help},
};

std::optional<std::uint32_t> sequence_in(std::string_view word) {
  if (word.size() < 3 || word.front() != '[' || word.back() != ']') return std::nullopt;
  const auto number = parse_digits(word.substr(1, word.size() - 2), 10);
  if (!number || *number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(*number);
}

}  // namespace

std::string Request::verb() const { return words.empty() ? std::string() : lower(words.front()); }
std::string Request::what() const { return words.size() < 2 ? std::string() : lower(words[1]); }

std::optional<std::uint64_t> parse_unsigned(std::string_view word) {
  const auto number = parse_integer(word);
  return number && word.find_first_of("hH") == std::string_view::npos ? number->as_unsigned() : std::nullopt;
}

Request take_apart(std::span<const std::string> words) {
  Request out;
  std::size_t at = 0;
  if (!words.empty() && (out.sequence = sequence_in(words.front()))) ++at;
  for (; at < words.size() && out.numbers.size() < 2; ++at) {
    const auto number = parse_unsigned(words[at]);
    if (!number) break;
    out.numbers.push_back(*number);
  }
  out.words.assign(words.begin() + static_cast<std::ptrdiff_t>(at), words.end());
  return out;
}

Service service_of(const Request& request) {
  const auto verb = request.verb();
  for (const auto& known : kSpellings)
    if (known.verb == verb && (known.what.empty() || known.what == request.what())) return known.service;
  return Service::other;
}

Result<ObjectAddress> object_of(const Request& request) {
  const auto word = [&](std::size_t at) {
    return at < request.words.size() ? request.words[at] : std::string();
  };
  const auto index = parse_unsigned(word(1));
  const auto sub = parse_unsigned(word(2));
  if (!index || *index > 0xFFFF) return fail(Errc::usage, message("'{}' is not an index", as_it_is(word(1))));
  if (!sub || *sub > 0xFF) return fail(Errc::usage, message("'{}' is not a sub-index", as_it_is(word(2))));
  return ObjectAddress{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub)};
}

}  // namespace servoctl::gateway
