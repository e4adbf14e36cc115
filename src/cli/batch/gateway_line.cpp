#include "cli/batch/gateway_line.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/object_address.hpp"
#include "base/text.hpp"
#include "cli/parse.hpp"
#include "gateway/request.hpp"

namespace servoctl::cli {
namespace {

using gateway::Request;
using gateway::Service;
using Words = std::vector<std::string>;

tl::unexpected<Error> wrong(Message message) {
  return fail(
      Errc::usage, "CiA 309-3: " + std::move(message),
      "[[NET] NODE] r INDEX SUB [TYPE], w INDEX SUB TYPE VALUE, start, stop, preop, reset node, reset comm");
}

/// The beginning can be no line of ours.
bool is_marked(const Request& line) { return line.sequence || !line.numbers.empty(); }

bool is_gateway_line(const Request& line) {
  if (is_marked(line)) return true;
  const auto verb = line.verb();
  if (verb == "r" || verb == "w") return true;
  if (verb == "set") return line.words.size() > 1 && (line.words[1] == "node" || line.words[1] == "network");
  const auto service = gateway::service_of(line);
  const bool known = service == Service::start || service == Service::stop || service == Service::preop ||
                     (verb == "reset" && line.words.size() == 2);
  return known && match_command(line.words).command == nullptr;
}

Result<Words> transfer(const Request& line) {
  const auto& words = line.words;
  const bool reads = gateway::service_of(line) == Service::read;
  if (reads ? words.size() < 3 || words.size() > 4 : words.size() != 5)
    return wrong(reads ? "a read takes INDEX SUB [TYPE]" : "a write takes INDEX SUB TYPE VALUE");
  const auto object = gateway::object_of(line);
  if (!object) return wrong(object.error().message);
  Words out{reads ? "read" : "write", to_string(*object)};
  const bool option =
      !reads && words[4].starts_with('-') && !parse_real(words[4]) && !parse_integer(words[4]);
  if (!reads && !option) out.push_back(words[4]);
  if (words.size() > 3) out.insert(out.end(), {"--type", lower(words[3])});
  if (option) out.insert(out.end(), {"--", words[4]});
  return out;
}

Result<Words> command(const Request& line) {
  const auto count = line.words.size();
  switch (gateway::service_of(line)) {
    case Service::read:
    case Service::write: return transfer(line);
    case Service::start:
      if (count == 1) return Words{"nmt", "start"};
      break;
    case Service::stop:
      if (count == 1) return Words{"nmt", "stop"};
      break;
    case Service::preop:
      if (count == 1) return Words{"nmt", "preop"};
      break;
    case Service::reset_node:
      if (count == 2) return Words{"nmt", "reset"};
      break;
    case Service::reset_communication:
      if (count == 2) return Words{"nmt", "reset-comm"};
      break;
    default: break;
  }
  return wrong(message("'{}' is not understood", as_it_is(fmt::to_string(fmt::join(line.words, " ")))));
}

Result<Words> set_default(const Request& line) {
  const auto number = line.words.size() == 3 ? gateway::parse_unsigned(line.words[2]) : std::nullopt;
  if (!number) return wrong(message("'set {}' takes a number", as_it_is(line.words[1])));
  if (line.words[1] == "node") return Words{"use", *number == 0 ? "all" : std::to_string(*number)};
  if (*number != 1) return wrong("servoctl works on one bus: the network can only be 1");
  return Words{};
}

Result<Words> translate(const Request& line) {
  if (line.words.empty()) return wrong("a command is missing");
  if (line.numbers.size() == 2 && line.numbers.front() != 1)
    return wrong(
        message("network {}: servoctl works on one bus, the network can only be 1", line.numbers.front()));
  if (line.verb() == "set" && line.words.size() > 1) return set_default(line);
  auto out = command(line);
  if (!out || line.numbers.empty()) return out;
  const auto node = line.numbers.back();
  out->insert(out->end(), {"-n", node == 0 ? "all" : std::to_string(node)});
  return out;
}

}  // namespace

std::optional<Result<Words>> from_gateway_line(const Words& words) {
  const auto line = gateway::take_apart(words);
  if (!is_gateway_line(line)) return std::nullopt;
  return translate(line);
}

}  // namespace servoctl::cli
