// What a gateway does with one line.
#include <fmt/format.h>

#include "base/format.hpp"
#include "canopen/nmt.hpp"
#include "gateway/words.hpp"
#include "session/can_network.hpp"
#include "session/gateway_server.hpp"

namespace servoctl::session {
namespace {

using gateway::Code;
using gateway::error_line;
using gateway::Request;
using gateway::Service;

constexpr std::uint64_t kOnlyNetwork = 1;

constexpr std::string_view kHelp =
    "\nLines begin with '[<sequence>]', then:\n"
    "[[<net>] <node>] r[ead] <index> <subindex> [<datatype>]\n"
    "[[<net>] <node>] w[rite] <index> <subindex> <datatype> <value>\n"
    "[[<net>] <node>] start | stop | preop[erational]\n"
    "[[<net>] <node>] reset node | reset comm[unication]\n"
    "[<net>] set network 1 | set node <value>\n"
    "[<net>] set sdo_timeout <ms> | set sdo_block <0|1>\n"
    "info version\n"
    "help\n"
    "Data types: b i8 i16 i24 i32 i40 i48 i56 i64 u8 ... u64 x8 x16 x32 x64 r32 r64 vs os us d t td hex;\n"
    "os us d are base64, t td are <days> <ms>, x8 to x64 and hex are not of the standard.\n"
    "Writes and NMT commands are refused (ERROR:102) unless the gateway was started with --allow write.\r\n";

bool is_command(Service service) {
  return service >= Service::start && service <= Service::reset_communication;
}

canopen::NmtCommand nmt_command_of(Service service) {
  switch (service) {
    case Service::stop: return canopen::NmtCommand::stop;
    case Service::preop: return canopen::NmtCommand::enter_pre_operational;
    case Service::reset_node: return canopen::NmtCommand::reset_node;
    case Service::reset_communication: return canopen::NmtCommand::reset_communication;
    default: return canopen::NmtCommand::start;
  }
}

NodeState state_of(Service service) {
  if (service == Service::stop) return NodeState::stopped;
  return service == Service::preop ? NodeState::pre_operational : NodeState::operational;
}

/// The node of a request, or why there is none.
struct Whom {
  std::uint8_t node = 0;
  std::optional<Code> wrong;
};

Whom node_of(const Request& request, const GatewayClient& client, std::uint64_t lowest) {
  if (request.numbers.empty() && !client.node) return {0, Code::no_default_node};
  const auto node = request.numbers.empty() ? *client.node : request.numbers.back();
  if (node < lowest || node > 127) return {0, Code::unsupported_node};
  return {static_cast<std::uint8_t>(node), std::nullopt};
}

bool is_other_network(const Request& request) {
  return request.numbers.size() == 2 && request.numbers.front() != kOnlyNetwork;
}

}  // namespace

void GatewayServer::handle(Client& client, const gateway::LineReader::Line& line) {
  const auto words = gateway::split_words(line.text);
  if (words && words->empty()) {
    client.out += "\r\n";  // An empty line, or a comment, is answered by an empty line.
    return;
  }
  // Of a line that cannot be read as a whole the sequence number may still be known.
  const auto end = std::min(line.text.find_first_of(" \t"), line.text.size());
  const auto first = std::vector<std::string>{line.text.substr(0, end)};
  const auto request = gateway::take_apart(words ? *words : first);
  const auto sequence = request.sequence.value_or(0);
  const auto service = gateway::service_of(request);
  const bool changes = service == Service::write || is_command(service);
  if (line.too_long)
    client.out += error_line(sequence, Code::syntax,
                             formatted("a line has {} bytes at most", gateway::LineReader::kLongest));
  else if (!words)
    client.out += error_line(sequence, Code::syntax, "a quote stands alone");
  else if (!request.sequence)
    client.out += error_line(0, Code::syntax, "a line begins with its number: [1]");
  else if (changes && client.is_cut && !client.in.has_line())
    client.out += error_line(sequence, Code::syntax, "the line has no end: it may have been cut short");
  else
    answer(client, sequence, request);
}

void GatewayServer::answer(Client& client, std::uint32_t sequence, const Request& request) {
  const auto service = gateway::service_of(request);
  auto& out = client.out;
  if (request.words.empty()) {
    out += error_line(sequence, Code::syntax, "a command is missing");
  } else if (is_other_network(request)) {
    out += error_line(sequence, Code::unsupported_network, "it is 1");
  } else if (service == Service::read || service == Service::write) {
    out += begin_transfer(client, sequence, request);
  } else if (is_command(service)) {
    out += command(client, sequence, request);
  } else if (service == Service::set) {
    out += set_default(client, sequence, request);
  } else if (service == Service::info && request.what() == "version") {
    // Vendor, product, revision and serial number: it has none. Class 1: no NMT master of its own.
    out += gateway::value_line(sequence, formatted("0 0 0.0 0 1 3.0 {}", options_.version));
  } else if (service == Service::help) {
    out += formatted("[{}] {}", sequence, kHelp);
  } else {
    out += error_line(sequence, Code::not_supported);
  }
}

void GatewayServer::refuse(Client& client, std::uint32_t sequence, const Request& request) {
  client.out += error_line(sequence, Code::internal_state, "this gateway only reads");
  if (++client.refused == 1)
    tell(formatted("refused '{}' of a client: --allow write allows it", fmt::join(request.words, " ")));
}

std::string GatewayServer::begin_transfer(Client& client, std::uint32_t sequence, const Request& request) {
  const bool reads = gateway::service_of(request) == Service::read;
  const auto whom = node_of(request, client, 1);
  if (whom.wrong) return error_line(sequence, *whom.wrong);
  const auto object = gateway::object_of(request);
  if (!object) return error_line(sequence, Code::syntax, object.error().message.text());
  const auto words = std::span(request.words).subspan(3);
  const auto type = words.empty() ? std::optional(gateway::ValueType{}) : gateway::parse_value_type(words[0]);
  if (!type) return error_line(sequence, Code::syntax, formatted("'{}' is not a data type", words[0]));
  if (reads ? words.size() > 1 : words.size() < 2)
    return error_line(sequence, Code::syntax, reads ? "r INDEX SUB [TYPE]" : "w INDEX SUB TYPE VALUE");
  Client::Order order{.request = {.node = whom.node, .object = *object}, .sequence = sequence, .type = *type};
  if (reads) {
    order.request.transfer = client.blocks ? canopen::Transfer::domain : canopen::Transfer::automatic;
  } else {
    auto bytes = gateway::parse_value(*type, words.subspan(1));
    if (!bytes) return error_line(sequence, Code::syntax, bytes.error().message.text());
    if (!options_.writes) {
      refuse(client, sequence, request);
      return {};
    }
    if (!client.blocks && bytes->size() > 4) order.request.transfer = canopen::Transfer::segmented;
    order.request.data = std::move(*bytes);
  }
  client.order = std::move(order);
  return {};
}

std::string GatewayServer::command(Client& client, std::uint32_t sequence, const Request& request) {
  const auto service = gateway::service_of(request);
  const bool of_two = service == Service::reset_node || service == Service::reset_communication;
  const auto whom = node_of(request, client, 0);
  if (whom.wrong) return error_line(sequence, *whom.wrong);
  if (request.words.size() != (of_two ? 2U : 1U))
    return error_line(sequence, Code::syntax, formatted("'{}' is too much", request.words.back()));
  if (session_->can() == nullptr && (of_two || whom.node == 0))
    return error_line(sequence, Code::not_supported, "it needs CAN");
  if (!options_.writes) {
    refuse(client, sequence, request);
    return {};
  }
  const auto sent = send_command(service, whom.node);
  return sent ? gateway::ok_line(sequence) : gateway::failure_line(sequence, sent.error());
}

Result<void> GatewayServer::send_command(Service service, std::uint8_t node) {
  auto* can = session_->can();
  if (can == nullptr) return session_->network().request_state(node, state_of(service));
  const auto sent = can->send(canopen::nmt_frame(nmt_command_of(service), node));
  if (sent) can->watch().on_command(node);
  return sent;
}

std::string GatewayServer::set_default(Client& client, std::uint32_t sequence, const Request& request) {
  constexpr std::uint64_t kLongestTimeout = 0xFFFF;
  const auto what = request.what();
  const bool known = what == "network" || what == "node" || what == "sdo_timeout" || what == "sdo_block";
  if (!known) return error_line(sequence, Code::not_supported);
  const auto number = request.words.size() == 3 ? gateway::parse_unsigned(request.words[2]) : std::nullopt;
  if (!number) return error_line(sequence, Code::syntax, formatted("'set {}' takes a number", what));
  if (what == "network" && *number != kOnlyNetwork)
    return error_line(sequence, Code::unsupported_network, "it is 1");
  if (what == "node") {
    if (*number < 1 || *number > 127) return error_line(sequence, Code::unsupported_node);
    client.node = static_cast<std::uint8_t>(*number);
  }
  if (what == "sdo_timeout") {
    if (*number < 1 || *number > kLongestTimeout)
      return error_line(sequence, Code::syntax, "it is 1 to 65535 ms");
    client.timeout = std::chrono::milliseconds(*number);
  }
  if (what == "sdo_block") {
    if (*number > 1) return error_line(sequence, Code::syntax, "it is 0 or 1");
    client.blocks = *number == 1;
  }
  return gateway::ok_line(sequence);
}

}  // namespace servoctl::session
