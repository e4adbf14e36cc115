#include "cli/batch/gateway_line.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/number.hpp"
#include "base/object_address.hpp"
#include "base/text.hpp"
#include "cli/parse.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

bool is_sequence(std::string_view word) {
  return word.size() > 2 && word.front() == '[' && word.back() == ']' &&
         parse_digits(word.substr(1, word.size() - 2), 10).has_value();
}

std::optional<std::uint64_t> unsigned_number(std::string_view word) {
  const auto number = parse_integer(word);
  return number && word.find_first_of("hH") == std::string_view::npos ? number->as_unsigned() : std::nullopt;
}

tl::unexpected<Error> wrong(std::string message) {
  return fail(
      Errc::usage, "CiA 309-3: " + std::move(message),
      "[[NET] NODE] r INDEX SUB [TYPE], w INDEX SUB TYPE VALUE, start, stop, preop, reset node, reset comm");
}

/// A line without its sequence number, network and node.
struct GatewayLine {
  Words words;
  std::vector<std::uint64_t> numbers;  ///< Network and node, node, or nothing.
  bool marked = false;                 ///< The beginning can be no line of ours.

  std::string verb() const { return words.empty() ? std::string() : lower(words.front()); }
};

GatewayLine take_apart(const Words& words) {
  GatewayLine out;
  std::size_t at = 0;
  if (!words.empty() && is_sequence(words.front())) ++at;
  for (; at < words.size() && out.numbers.size() < 2; ++at) {
    const auto number = unsigned_number(words[at]);
    if (!number) break;
    out.numbers.push_back(*number);
  }
  out.marked = at > 0;
  out.words.assign(words.begin() + static_cast<std::ptrdiff_t>(at), words.end());
  return out;
}

bool is_gateway_line(const GatewayLine& line) {
  if (line.marked) return true;
  const auto verb = line.verb();
  if (verb == "r" || verb == "w") return true;
  if (verb == "set") return line.words.size() > 1 && (line.words[1] == "node" || line.words[1] == "network");
  const bool known = verb == "start" || verb == "stop" || verb == "preop" || verb == "preoperational" ||
                     (verb == "reset" && line.words.size() == 2);
  return known && match_command(line.words).command == nullptr;
}

Result<std::string> address(const GatewayLine& line) {
  const auto index = unsigned_number(line.words[1]);
  const auto sub = unsigned_number(line.words[2]);
  if (!index || *index > 0xFFFF) return wrong(fmt::format("'{}' is not an index", line.words[1]));
  if (!sub || *sub > 0xFF) return wrong(fmt::format("'{}' is not a sub-index", line.words[2]));
  return to_string(ObjectAddress{static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub)});
}

Result<Words> transfer(const GatewayLine& line) {
  const auto& words = line.words;
  const bool reads = line.verb() == "r" || line.verb() == "read";
  if (reads ? words.size() < 3 || words.size() > 4 : words.size() != 5)
    return wrong(reads ? "a read takes INDEX SUB [TYPE]" : "a write takes INDEX SUB TYPE VALUE");
  const auto object = address(line);
  if (!object) return fail(object.error());
  Words out{reads ? "read" : "write", *object};
  const bool option =
      !reads && words[4].starts_with('-') && !parse_real(words[4]) && !parse_integer(words[4]);
  if (!reads && !option) out.push_back(words[4]);
  if (words.size() > 3) out.insert(out.end(), {"--type", lower(words[3])});
  if (option) out.insert(out.end(), {"--", words[4]});
  return out;
}

Result<Words> command(const GatewayLine& line) {
  const auto verb = line.verb();
  const auto what = line.words.size() == 2 ? lower(line.words[1]) : std::string();
  if (verb == "r" || verb == "read" || verb == "w" || verb == "write") return transfer(line);
  if (verb == "reset" && what == "node") return Words{"nmt", "reset"};
  if (verb == "reset" && (what == "comm" || what == "communication")) return Words{"nmt", "reset-comm"};
  if (line.words.size() == 1 && (verb == "start" || verb == "stop")) return Words{"nmt", verb};
  if (line.words.size() == 1 && (verb == "preop" || verb == "preoperational")) return Words{"nmt", "preop"};
  return wrong(fmt::format("'{}' is not understood", fmt::join(line.words, " ")));
}

Result<Words> set_default(const GatewayLine& line) {
  const auto number = line.words.size() == 3 ? unsigned_number(line.words[2]) : std::nullopt;
  if (!number) return wrong(fmt::format("'set {}' takes a number", line.words[1]));
  if (line.words[1] == "node") return Words{"use", *number == 0 ? "all" : std::to_string(*number)};
  if (*number != 1) return wrong("servoctl works on one bus: the network can only be 1");
  return Words{};
}

Result<Words> translate(const GatewayLine& line) {
  if (line.words.empty()) return wrong("a command is missing");
  if (line.numbers.size() == 2 && line.numbers.front() != 1)
    return wrong(fmt::format("network {}: servoctl works on one bus, the network can only be 1",
                             line.numbers.front()));
  if (line.verb() == "set" && line.words.size() > 1) return set_default(line);
  auto out = command(line);
  if (!out || line.numbers.empty()) return out;
  const auto node = line.numbers.back();
  out->insert(out->end(), {"-n", node == 0 ? "all" : std::to_string(node)});
  return out;
}

}  // namespace

std::optional<Result<Words>> from_gateway_line(const Words& words) {
  const auto line = take_apart(words);
  if (!is_gateway_line(line)) return std::nullopt;
  return translate(line);
}

}  // namespace servoctl::cli
