// How a network comes to the slaves of its ring: it looks, gives them their addresses, and opens mailboxes.
#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "ethercat/registers.hpp"
#include "ethercat/request_sequence.hpp"
#include "ethercat/sii_reader.hpp"
#include "ethercat/words.hpp"
#include "session/ethercat_network.hpp"
#include "session/ethercat_object_channel.hpp"
#include "session/ring_state.hpp"

namespace servoctl::session {
namespace {

namespace reg = ethercat::reg;
using ethercat::AlState;
using ethercat::SlaveAddress;

constexpr std::size_t kMostNodes = 127;

SlaveAddress at_place(std::size_t index) {
  return SlaveAddress::at_position(static_cast<std::uint16_t>(index));
}

ethercat::Request count_request() {
  return {ethercat::Command::brd, ethercat::physical_address(0, reg::kAlStatus), Bytes(2), true};
}

/// The mailbox by the settings of SM0 and SM1; does not exist where they are off, or are none.
ethercat::SiiMailbox mailbox_in(ByteSpan managers) {
  const auto is_on = [&](std::size_t at) { return (managers[at + 6] & reg::kSmEnable) != 0; };
  constexpr std::uint8_t kDirectionAndMode = 0x0F;
  const bool out = (managers[4] & kDirectionAndMode) == (reg::kSmMailboxOut & kDirectionAndMode);
  const bool in = (managers[12] & kDirectionAndMode) == (reg::kSmMailboxIn & kDirectionAndMode);
  if (!is_on(0) || !is_on(8) || !out || !in) return {};
  return {ethercat::word_at(managers, 0), ethercat::word_at(managers, 2), ethercat::word_at(managers, 8),
          ethercat::word_at(managers, 10)};
}

}  // namespace

Error EtherCatNetwork::nothing_back() const {
  if (!wire_.port().has_link())
    return make_error(Errc::bus, message("{} has no link", as_it_is(url_)),
                      "is the cable plugged in, and is the first drive powered?");
  return make_error(
      Errc::bus, message("{}: frames do not come back", as_it_is(url_)),
      "is this the port with the drives? Between it and the first one there must be no switch, and "
      "nothing else may use it: NetworkManager can be told with `nmcli device set IFACE managed no`");
}

Error EtherCatNetwork::no_answer(std::uint8_t node) const {
  if (node > present_) return no_slave_at(node, present_);
  return drive_error(Errc::timeout, node, "it does not answer", silence_hint(node));
}

Result<void> EtherCatNetwork::count_slaves() {
  const auto replies = wire_.exchange({count_request()});
  if (!replies) return fail(replies.error());
  const auto& reply = replies->front();
  if (reply.lost) return fail(nothing_back());
  if (reply.working_counter == 0)
    return fail(
        Errc::bus, message("{}: no EtherCAT slave is there", as_it_is(url_)),
        "frames come back and nobody has touched them: is this the port with the drives, and is the first "
        "one powered?");
  present_ = reply.working_counter;
  if (!numbered_) count_ = present_;
  changed_ = changed_ || present_ > count_;
  return {};
}

/// A count may come back short: one slave more is asked for than there are by it.
Result<std::vector<EtherCatNetwork::Glance>> EtherCatNetwork::glance() {
  constexpr unsigned kTries = 3;
  for (unsigned tries = 0;; ++tries) {
    if (const auto counted = count_slaves(); !counted) return fail(counted.error());
    if (changed_) return fail(numbered_otherwise());
    auto slaves = glance_at(present_);
    if (!slaves || slaves->size() == std::min(present_, kMostNodes)) return slaves;
    if (tries == kTries)
      return fail(make_error(Errc::bus, message("{}: its slaves cannot be counted", as_it_is(url_)),
                             "working counters come back wrong: the error counters of `scan` show between "
                             "which slaves frames are damaged"));
  }
}

/// The first so many; with one more where there is one.
Result<std::vector<EtherCatNetwork::Glance>> EtherCatNetwork::glance_at(std::size_t count) {
  const auto most = std::min(count, kMostNodes);
  constexpr std::size_t kEach = 3;
  std::vector<ethercat::Request> requests;
  for (std::size_t i = 0; i < most; ++i) {
    requests.push_back(read_registers(at_place(i), reg::kStationAddress, 2));
    requests.push_back(read_registers(at_place(i), reg::kAlStatus, reg::kAlStatusSize));
    requests.push_back(read_registers(at_place(i), reg::sync_manager(0), 2 * reg::kSyncManagerSize));
  }
  if (most < kMostNodes) requests.push_back(read_once(at_place(most), reg::kStationAddress, 2));
  const auto replies = wire_.exchange(requests);
  if (!replies) return fail(replies.error());
  std::vector<Glance> out;
  for (std::size_t i = 0; i < most; ++i) {
    const auto* reply = &(*replies)[kEach * i];
    if (!reply[0].done() || !reply[1].done() || !reply[2].done())
      return fail(drive_error(Errc::timeout, static_cast<std::uint8_t>(i + 1), "it does not answer",
                              silence_hint(static_cast<std::uint8_t>(i + 1))));
    out.push_back({ethercat::word_at(reply[0].data, 0), ethercat::parse_al_status(reply[1].data),
                   mailbox_in(reply[2].data)});
  }
  if (most < kMostNodes && replies->back().done()) out.emplace_back();
  return out;
}

bool EtherCatNetwork::is_foreign(std::uint8_t node, const ethercat::AlStatus& al) const {
  const auto* known = find(node);
  return is_driven(al) && !taken_over_[node] && (known == nullptr || !known->raised);
}

/// Nothing is written to a ring that somebody else works with. What servoctl itself has taken up, or was told
/// to take over, is its own.
Result<void> EtherCatNetwork::check_free(const EtherCatNode& node, const std::vector<Glance>& slaves) const {
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    const auto number = static_cast<std::uint8_t>(i + 1);
    if (!is_foreign(number, slaves[i].al)) continue;
    return fail(drive_error(
        Errc::refused, node.number,
        message("another master works with this ring: node {} is in {}", node_name(number),
                name(slaves[i].al.state)),
        message("servoctl only looks then: `scan`. If that master is gone, `state preop --take-over -n {}` "
                "takes the slave over",
                node_name(number))));
  }
  return {};
}

Error EtherCatNetwork::numbered_otherwise() const {
  return make_error(Errc::bus,
                    message("{}: the ring has changed since its slaves were numbered", as_it_is(url_)),
                    "a node is a position on the ring: `scan` numbers them anew");
}

/// Gives every slave the address of its place. Once that is done, only to those that have restarted: another
/// place on the ring must not become another node in the middle of a job.
Result<void> EtherCatNetwork::claim(const std::vector<Glance>& slaves) {
  std::vector<ethercat::Request> requests;
  for (std::size_t i = 0; numbered_ && i < slaves.size(); ++i)
    changed_ = changed_ ||
               (slaves[i].station != 0 && slaves[i].station != station_of(static_cast<std::uint8_t>(i + 1)));
  if (changed_) return fail(numbered_otherwise());
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    const auto station = station_of(static_cast<std::uint8_t>(i + 1));
    if (slaves[i].station == station) continue;
    for (auto& request : ethercat::station_setup(static_cast<std::uint16_t>(i), station))
      requests.push_back(std::move(request));
  }
  if (!requests.empty()) {
    const auto replies = wire_.exchange(requests);
    if (!replies) return fail(replies.error());
  }
  numbered_ = true;
  if (watching_.next == kNever) watching_.next = now() + std::chrono::milliseconds(100);
  return {};
}

/// Numbers the slaves where that has to be done, and takes note of what this one says of itself.
Result<EtherCatNetwork::Glance> EtherCatNetwork::find_slave(EtherCatNode& node) {
  const auto slaves = glance();
  if (!slaves) return fail(slaves.error());
  if (node.number > slaves->size()) return fail(no_answer(node.number));
  if (const auto free = check_free(node, *slaves); !free) return fail(free.error());
  if (const auto claimed = claim(*slaves); !claimed) return fail(claimed.error());
  const auto& found = (*slaves)[node.number - 1U];
  hear(node, found.al, now(), true);
  node.gone = false;
  node.missed = 0;
  return found;
}

/// For what needs no mailbox.
Result<void> EtherCatNetwork::approach(EtherCatNode& node) {
  if (node.coe) return {};
  const auto found = find_slave(node);
  if (!found) return fail(found.error());
  return {};
}

Result<void> EtherCatNetwork::prepare(EtherCatNode& node) {
  if (node.coe) return {};
  const auto found = find_slave(node);
  if (!found) return fail(found.error());
  if (found->al.state == AlState::init) return bring_up(node);
  if (found->al.state == AlState::boot)
    return fail(drive_error(Errc::negative, node.number, "it is in BOOT and takes firmware only",
                            message("`{}`", state_command(node.number, NodeState::initialising))));
  if (!found->mailbox.exists() || !found->mailbox.doubt().empty())
    return fail(drive_error(
        Errc::protocol, node.number,
        found->mailbox.exists() ? message("its mailbox cannot be used: {}", found->mailbox.doubt())
                                : "its mailbox is not set up, so its objects cannot be reached",
        message("`{}` and `{}` set it up anew", state_command(node.number, NodeState::initialising),
                state_command(node.number, NodeState::pre_operational))));
  // A slave takes a message with the counter of the last one, by whomever, for a repetition. One without
  // is always new.
  open_mailbox(node, found->mailbox, 0);
  return {};
}

void EtherCatNetwork::open_mailbox(EtherCatNode& node, const ethercat::SiiMailbox& place,
                                   std::uint8_t first_counter) {
  ethercat::Mailbox::Options options;
  options.place = place;
  options.first_counter = first_counter;
  node.coe = std::make_unique<ethercat::CoeSlave>(node.number, node.address(), options,
                                                  std::chrono::milliseconds(500));
  node.coe->mailbox().start(now());
}

/// By its SII; where that does not tell it, by what is known of its family.
Result<ethercat::SiiMailbox> EtherCatNetwork::mailbox_place(EtherCatNode& node) {
  ethercat::SiiReader reader(node.number, node.address());
  reader.start_head(ethercat::kSiiHeader, now());
  const auto head = wire_.ask(reader);
  if (!head && (head.error().code == Errc::bus || head.error().code == Errc::interrupted))
    return fail(head.error());
  const auto sii = head ? ethercat::parse_sii(*head) : ethercat::SiiImage{};
  const bool usable = sii.mailbox.exists() && sii.mailbox.doubt().empty() && !sii.is_empty();
  if (usable && (sii.protocols & ethercat::kProtocolCoe) != 0) return sii.mailbox;
  const auto why = !head                   ? head.error().message
                   : sii.is_empty()        ? std::string("its SII is empty")
                   : !sii.mailbox.exists() ? std::string("by its SII it has no mailbox")
                   : !usable               ? "its SII: " + sii.mailbox.doubt()
                                           : std::string("by its SII its mailbox does not speak CoE");
  const auto& rules = node.rules;
  if (rules.exists()) {
    notices_.push_back(
        message("node {}: {}; the mailbox of its family is used", node_name(node.number), why));
    return ethercat::SiiMailbox{rules.mailbox_out.start, rules.mailbox_out.size, rules.mailbox_in.start,
                                rules.mailbox_in.size};
  }
  return fail(
      drive_error(Errc::negative, node.number, message("its objects cannot be reached: {}", why),
                  "if it is a drive whose family servoctl knows, name the family with -d; `scan` shows "
                  "what the slaves say of themselves"));
}

Result<void> EtherCatNetwork::bring_up(EtherCatNode& node) {
  const auto place = mailbox_place(node);
  if (!place) return fail(place.error());
  const auto replies = wire_.exchange({ethercat::mailbox_setup(node.address(), *place)});
  if (!replies) return fail(replies.error());
  if (!replies->front().done()) return fail(no_answer(node.number));
  if (const auto there = go_to(node, AlState::preop); !there) return fail(there.error());
  open_mailbox(node, *place, 1);
  return {};
}

Result<ethercat::AlStatus> EtherCatNetwork::go_to(EtherCatNode& node, AlState state) {
  ethercat::AlRequest request(node.number, node.address());
  request.start(state, now());
  if (ordered_) ordered_(node.number, state_order(node_state(state)));
  auto there = wire_.ask(request);
  if (there) {
    hear(node, *there, now(), true);
    if (state == AlState::preop || state == AlState::init) set_raised(node, false);
    // What is driven later on is somebody else's again.
    if (state == AlState::preop || state == AlState::init) taken_over_[node.number] = false;
  } else if (there.error().code == Errc::negative) {
    request.start_look(now());
    if (const auto found = wire_.ask(request)) node.al = *found;
  }
  return there;
}

void EtherCatNetwork::forget_mailbox(EtherCatNode& node, const Error& why) {
  if (node.coe) node.coe->leave(wire_.ring());
  if (auto* owner = std::exchange(node.owner, nullptr)) owner->on_lost(why);
  node.coe.reset();
}

Result<ethercat::CoeSlave*> EtherCatNetwork::mailbox_of(std::uint8_t node) {
  auto& known = of(node);
  if (const auto ready = prepare(known); !ready) return fail(ready.error());
  return known.coe.get();
}

}  // namespace servoctl::session
