// What a network hears of its slaves while it waits for something else: their states, whether they are there.
#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "ethercat/registers.hpp"
#include "session/ethercat_network.hpp"
#include "session/ethercat_object_channel.hpp"

namespace servoctl::session {
namespace {

namespace reg = ethercat::reg;
using ethercat::AlState;

constexpr Duration kPeriod = std::chrono::milliseconds(100);
/// Looks in succession that a slave has missed when it is told to be gone.
constexpr unsigned kMostMissed = 2;

}  // namespace

void EtherCatNetwork::watch(ethercat::Ring& ring, TimePoint now) {
  if (watching_.count) take_answers(ring, now);
  if (!watching_.count && now >= watching_.next) ask_all(ring, now);
}

/// One frame: how many there are, and the state of each that somebody has asked for something.
void EtherCatNetwork::ask_all(ethercat::Ring& ring, TimePoint now) {
  watching_.count =
      ring.post({ethercat::Command::brd, ethercat::physical_address(0, reg::kAlStatus), Bytes(2), true});
  if (!watching_.count) return;
  watching_.counted.reset();
  for (const auto* node : known_) {
    if (!node->coe && !node->gone) continue;
    const auto ticket =
        ring.post(ethercat::read_registers(node->address(), reg::kAlStatus, reg::kAlStatusSize));
    if (ticket) watching_.nodes.push_back({node->number, *ticket});
  }
  watching_.next = now + kPeriod;
}

void EtherCatNetwork::take_answers(ethercat::Ring& ring, TimePoint now) {
  if (!watching_.counted) {
    const auto answer = ring.take_answer(*watching_.count);
    if (!answer) return;
    on_count(*answer);
  }
  auto& open = watching_.nodes;
  for (std::size_t i = 0; i < open.size();) {
    const auto answer = ring.take_answer(open[i].ticket);
    if (!answer) {
      ++i;
      continue;
    }
    auto& node = *nodes_[open[i].node];
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(i));
    on_state(node, *answer, now);
  }
  if (open.empty()) watching_.count.reset();
}

void EtherCatNetwork::on_count(const ethercat::Answer& answer) {
  watching_.counted = answer.lost ? 0 : answer.working_counter;
  watching_.lost = answer.lost ? watching_.lost + 1 : 0;
  if (answer.lost || !numbered_ || changed_ || answer.working_counter <= count_) return;
  changed_ = true;
  notices_.push_back(message(
      "{}: {} slaves are on the ring now, {} when they were numbered; a node is a position, and `scan` numbers "
      "them anew",
      as_it_is(url_), answer.working_counter, count_));
}

void EtherCatNetwork::on_state(EtherCatNode& node, const ethercat::Answer& answer, TimePoint now) {
  if (answer.lost || answer.working_counter == 0) return on_missing(node, now);
  if (answer.working_counter > 1)
    tell(node.number, NodeEvent::Doubled{formatted("station address {:04X}h", station_of(node.number))}, now);
  node.missed = 0;
  const auto al = ethercat::parse_al_status(answer.data);
  if (std::exchange(node.gone, false)) tell(node.number, NodeEvent::Back{node_state(al.state)}, now);
  hear(node, al, now, false);
}

/// A slave without an address where all are there has started anew.
void EtherCatNetwork::on_missing(EtherCatNode& node, TimePoint now) {
  if (++node.missed < kMostMissed || node.gone) return;
  const bool all_there = watching_.counted.value_or(0) >= count_ && count_ != 0;
  const auto why =
      drive_error(Errc::timeout, node.number, all_there ? "it has restarted" : "it is no longer on the ring",
                  silence_hint(node.number));
  const bool was_driven = node.exchanges();
  end_cycles(node);
  forget_mailbox(node, why);
  set_raised(node, false);
  node.kept = false;
  if (all_there) {
    ++node.boots;
    node.al.reset();
    node.emergencies.clear();
    return tell(node.number, NodeEvent::BootUp{}, now);
  }
  node.gone = true;
  set_raised(node, was_driven);
  tell(node.number, NodeEvent::Gone{now - node.heard_at, NodeEvent::Gone::Sign::counter}, now);
}

/// `expected`: servoctl has asked for this state.
void EtherCatNetwork::hear(EtherCatNode& node, const ethercat::AlStatus& al, TimePoint now, bool expected) {
  const auto before = std::exchange(node.al, al);
  node.heard_at = now;
  ++node.reports;
  if (before && !expected && before->state != al.state)
    tell(node.number, NodeEvent::StateChange{node_state(al.state)}, now);
  const bool new_error = al.error && !(before && before->error && before->code == al.code);
  if (new_error) tell(node.number, NodeEvent::StateError{al.code, ethercat::al_status_text(al.code)}, now);
  if (expected || !before) return;
  if (al.state != before->state) node.kept = false;
  if (node.exchanges() && al.state != before->state) end_cycles(node);
  if (al.state == AlState::init || al.state == AlState::boot)
    forget_mailbox(node, drive_error(Errc::negative, node.number, "it went to INIT: its mailbox is closed"));
}

void EtherCatNetwork::end_cycles(EtherCatNode& node) {
  if (!node.image) return;
  if (node.clock) node.clock->leave(wire_.ring());
  node.clock.reset();
  node.image->stop();
  node.image->leave(wire_.ring());
  const auto& counts = node.image->counts(node.number);
  const auto& rhythm = node.image->rhythm();
  const auto late = std::chrono::duration_cast<std::chrono::milliseconds>(rhythm.latest).count();
  if (counts.lost + counts.short_outputs + counts.short_inputs + rhythm.skipped > 0)
    notices_.push_back(message(
        "node {}: {} cycles of process data: {} frames lost, {} outputs not taken, {} inputs not given, {} cycles "
        "left out because servoctl was late (by {} ms at most)",
        node_name(node.number), counts.cycles, counts.lost, counts.short_outputs, counts.short_inputs,
        rhythm.skipped, late));
  node.image.reset();
}

}  // namespace servoctl::session
