#include "session/addressing.hpp"

#include <algorithm>
#include <set>

#include "canopen/cob_id.hpp"
#include "canopen/node_id.hpp"
#include "canopen/node_list.hpp"
#include "canopen/sdo_frame.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/hearing.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {
namespace {

using drive::NmtRules;

/// How often a drive that is to come back is asked for beside its boot-up.
constexpr Duration kAskAgain = std::chrono::seconds(2);
/// A node answers within some milliseconds.
constexpr Duration kProbe = std::chrono::milliseconds(100);

std::optional<canopen::NmtCommand> command_of(NmtRules::Restart how) {
  switch (how) {
    case NmtRules::Restart::reset_node: return canopen::NmtCommand::reset_node;
    case NmtRules::Restart::reset_communication: return canopen::NmtCommand::reset_communication;
    case NmtRules::Restart::power_cycle: break;
  }
  return std::nullopt;
}

/// Who sends a frame by the pre-defined connection set (CiA 301, 7.3.5); 0: nobody that could be told. An
/// RPDO and a request come from others than the node in their CAN-ID.
std::uint8_t sender_of(const can::Frame& frame) {
  if (frame.extended || frame.error || frame.remote) return 0;
  const auto node = static_cast<std::uint8_t>(frame.id & 0x7FU);
  switch (frame.id - node) {
    case canopen::kEmergency:
    case 0x180:
    case 0x280:
    case 0x380:
    case 0x480:
    case canopen::kSdoAnswer:
    case canopen::kErrorControl: return node;
    default: return 0;
  }
}

constexpr std::string_view kItAnswers = "it answers";

/// `asked` by node guarding: an answer is no different from a heartbeat.
std::string_view what_it_sends(const can::Frame& frame, bool asked) {
  const auto service = frame.id & ~0x7FU;
  if (service == canopen::kErrorControl) {
    if (!asked) return "it sends heartbeats";
    const auto message = canopen::parse_error_control(frame);
    return message && message->state == canopen::NmtState::stopped
               ? "it says that it is stopped (NMT)"
               : "it answers node guarding, or sends heartbeats";
  }
  return service == canopen::kSdoAnswer ? kItAnswers : "it sends PDOs or emergencies";
}

bool has_answered(const Result<Bytes>& answer) {
  return answer || answer.error().code == Errc::sdo_abort || answer.error().code == Errc::protocol;
}

bool says_energised(const can::Frame& frame, std::uint8_t node) {
  constexpr std::uint8_t kReadAnswer = 2;  // CiA 301, 7.2.4.3.6: initiate upload response.
  if (frame.extended || frame.error || frame.remote || frame.size != 8) return false;
  if (frame.id != canopen::kSdoAnswer + node || frame.data[0] >> 5U != kReadAnswer) return false;
  if (canopen::sdo_object(frame) != objects::kStatusword) return false;
  return drive::is_energised(
      drive::decode_state(static_cast<std::uint16_t>(frame.data[4] | frame.data[5] << 8U)));
}

}  // namespace

std::string sharers_of(Session& session, std::uint8_t node) {
  auto* can = session.can();
  return can != nullptr && node >= canopen::kFirstNode && node <= canopen::kLastNode
             ? can->duplicates().noticed(node)
             : std::string();
}

Result<bool> is_energised(Session& session, std::uint8_t node) {
  bool heard = false;
  const Hearing hearing(
      session, [&](const can::Frame& frame, TimePoint) { heard = heard || says_energised(frame, node); });
  const auto word = session.upload(node, objects::kStatusword);
  if (word && drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word)))))
    return true;
  if (!heard && !sharers_of(session, node).empty())
    if (const auto waited = session.wait([&] { return heard; }, session.now() + kBeforeMotion); !waited)
      return fail(waited.error());
  if (heard) return true;
  return word || word.error().code == Errc::sdo_abort ? Result<bool>(false) : fail(word.error());
}

Result<bool> is_any_axis_energised(Session& session, std::uint8_t node) {
  const auto first = is_energised(session, node);
  if (!first || *first) return first;
  const auto further = further_axes(session, node);
  const bool any = std::any_of(further.axes.begin(), further.axes.end(), [](const FurtherAxis& axis) {
    return drive::is_energised(drive::decode_state(axis.statusword));
  });
  if (!any && further.failure) return fail(*further.failure);
  return any;
}

FurtherAxes further_axes(Session& session, std::uint8_t node) {
  FurtherAxes out;
  if (session.wary_of(node) != nullptr) return out;
  const auto type = session.upload(node, objects::kDeviceType);
  if (!type && type.error().code != Errc::sdo_abort) out.failure = type.error();
  if (!type || !drive::is_drive_type(load_le(*type))) return out;
  const auto alarms = session.watch().alarms(node);
  bool lacks_any = false;
  for (unsigned number = 2; number <= drive::kMostAxes; ++number) {
    // An EMCY of another cause leaves no axis unseen.
    if (lacks_any && session.watch().alarms(node) != alarms) break;
    const auto word = session.upload(node, drive::of_axis(objects::kStatusword, number));
    if (word) {
      out.axes.push_back({number, static_cast<std::uint16_t>(load_le(*word))});
    } else if (word.error().code == Errc::sdo_abort) {
      lacks_any = true;
    } else {
      out.failure = word.error();
      break;
    }
  }
  return out;
}

Result<std::map<std::uint8_t, std::string>> nodes_in_use(Session& session,
                                                         std::span<const std::uint8_t> nodes,
                                                         const AddressLook& look) {
  std::map<std::uint8_t, std::string> out;
  auto* can = session.can();
  if (can == nullptr) return out;
  const std::set<std::uint8_t> wanted(nodes.begin(), nodes.end());
  bool asked = false;
  const Hearing hearing(session, [&](const can::Frame& frame, TimePoint) {
    if (const auto node = sender_of(frame); wanted.count(node) > 0)
      out.emplace(node, what_it_sends(frame, asked));
  });
  const auto own = can->heartbeat_node();
  if (own && wanted.count(*own) > 0) out[*own] = "it carries servoctl's own heartbeat";
  const auto all = [&] { return out.size() == wanted.size(); };
  const auto until = session.now() + look.listening;
  std::vector<SdoRequest> questions;
  for (const auto node : wanted) questions.push_back({.node = node, .object = objects::kDeviceType});
  {
    const OptionScope once(session, &Options::retries, 0U);
    const auto found = session.transfer(questions);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (has_answered(found[i])) out[questions[i].node] = kItAnswers;
      if (!found[i] && (found[i].error().code == Errc::bus || found[i].error().code == Errc::interrupted))
        return fail(found[i].error());
    }
  }
  if (const auto waited = session.wait(all, until); !waited) return fail(waited.error());
  if (all() || !look.guards || !guards_nodes(session)) return out;
  // A stopped node has no SDO. One that another master guards was heard by now.
  asked = true;
  for (const auto node : wanted)
    if (out.count(node) == 0)
      if (const auto sent = session.network().ask_state(node); !sent) return fail(sent.error());
  if (const auto waited = session.wait(all, session.now() + kProbe); !waited) return fail(waited.error());
  return out;
}

bool guards_nodes(Session& session) { return session.network().carries(LifeSign::Kind::guarding); }

Result<std::vector<std::uint8_t>> nodes_beside(Session& session, std::span<const std::uint8_t> nodes,
                                               const AddressLook& look) {
  const auto used = nodes_in_use(session, canopen::every_node_id(), look);
  if (!used) return fail(used.error());
  const auto* can = session.can();
  std::vector<std::uint8_t> out;
  for (const auto& [node, how] : *used) {
    const bool is_own = can != nullptr && can->heartbeat_node() == node;
    if (!is_own && std::find(nodes.begin(), nodes.end(), node) == nodes.end()) out.push_back(node);
  }
  return out;
}

void forget_node(Session& session, std::uint8_t node) {
  session.identities().forget(node);
  if (auto* can = session.can()) {
    can->watch().forget(node);
    can->duplicates().forget(node);
  }
}

Result<void> restart_node(Session& session, std::uint8_t node, NmtRules::Restart how) {
  const auto command = command_of(how);
  auto* can = session.can();
  if (!command || can == nullptr) return {};
  const auto sent = can->send(canopen::nmt_frame(*command, node));
  forget_node(session, node);
  return sent;
}

std::string restart_frame(std::uint8_t node, NmtRules::Restart how) {
  const auto command = command_of(how);
  return command ? can::to_string(canopen::nmt_frame(*command, node)) : std::string();
}

Result<void> wait_for_boot(Session& session, std::uint8_t from, std::uint8_t to, TimePoint deadline) {
  const auto before_from = session.watch().boots(from);
  const auto before_to = session.watch().boots(to);
  const auto booted = [&] {
    return session.watch().boots(to) > before_to || session.watch().boots(from) > before_from;
  };
  while (!booted() && session.now() < deadline) {
    const auto waited = session.wait(booted, std::min(deadline, session.now() + kAskAgain));
    if (!waited) return fail(waited.error());
    if (*waited || to == from) continue;
    const Hurry hurry(session, kProbe, 0);
    const auto there = session.upload(to, objects::kDeviceType);
    if (has_answered(there)) break;
    if (there.error().code == Errc::bus || there.error().code == Errc::interrupted)
      return fail(there.error());
  }
  return {};
}

}  // namespace servoctl::session
