#include "sim/esc_ring.hpp"

#include <algorithm>
#include <utility>

#include "ethercat/frame.hpp"

namespace servoctl::sim {

void EscRing::attach(EscSlave& slave, TimePoint now) {
  slaves_.push_back({&slave});
  slave.power_on(now);
  update_links();
}

/// Whether frames cross the cable in front of this slave.
bool EscRing::joins(std::size_t cable) const {
  const auto& place = slaves_[cable];
  return !place.cut && place.powered && (cable == 0 || slaves_[cable - 1].powered);
}

std::size_t EscRing::reachable() const {
  std::size_t count = 0;
  while (count < slaves_.size() && joins(count)) ++count;
  return count;
}

void EscRing::update_links() {
  for (std::size_t i = 0; i < slaves_.size(); ++i) {
    if (!slaves_[i].powered) continue;
    slaves_[i].slave->registers().set_link(0, joins(i));
    slaves_[i].slave->registers().set_link(1, i + 1 < slaves_.size() && joins(i + 1));
  }
}

void EscRing::cut_cable(std::size_t slave) {
  slaves_[slave].cut = true;
  update_links();
}

void EscRing::join_cable(std::size_t slave) {
  slaves_[slave].cut = false;
  update_links();
}

void EscRing::power_off(std::size_t slave) {
  slaves_[slave].powered = false;
  update_links();
}

void EscRing::power_on(std::size_t slave, TimePoint now) {
  slaves_[slave].powered = true;
  slaves_[slave].slave->power_on(now);
  update_links();
}

void EscRing::on_frame(ByteSpan frame, TimePoint now) {
  on_time(now);
  ++sent_;
  if (reachable() == 0 || faults_.lost_requests.contains(sent_)) return;
  Bytes passing(frame.begin(), frame.end());
  if (!pass(passing, now) || !comes_back()) return;
  if (comes_back_short()) shorten_counters(passing);
  returning_.push_back({std::move(passing), now + faults_.delay});
}

bool EscRing::pass(Bytes& frame, TimePoint now) {
  const auto count = reachable();
  if (!ethercat::is_ethercat(frame))
    return std::none_of(slaves_.begin(), slaves_.begin() + static_cast<std::ptrdiff_t>(count),
                        [](const Place& p) { return p.slave->registers().destroys_foreign_frames(); });
  for (std::size_t i = 0; i < count; ++i) {
    if (is_damaged(i, false)) {
      slaves_[i].slave->registers().count_damage(0);
      return false;
    }
    if (!slaves_[i].slave->on_frame(frame, now)) return false;
  }
  for (std::size_t i = count; i > 0; --i) {
    if (!is_damaged(i - 1, true)) continue;
    if (i > 1) slaves_[i - 2].slave->registers().count_damage(1);
    return false;
  }
  return true;
}

bool EscRing::is_damaged(std::size_t cable, bool way_back) const {
  const auto found = faults_.damaged.find(sent_);
  return found != faults_.damaged.end() && found->second.cable == cable && found->second.way_back == way_back;
}

bool EscRing::comes_back() const {
  const bool is_one_of_many = faults_.loses_every != 0 && sent_ % faults_.loses_every == 0;
  return !is_one_of_many && !faults_.lost_answers.contains(sent_);
}

bool EscRing::comes_back_short() const {
  const bool is_one_of_many = faults_.shortens_every != 0 && sent_ % faults_.shortens_every == 0;
  return is_one_of_many || faults_.short_counters.contains(sent_);
}

void EscRing::shorten_counters(Bytes& frame) {
  auto reader = ethercat::FrameReader::open(frame);
  if (!reader) return;
  while (const auto datagram = reader->next())
    if (datagram->working_counter > 0)
      set_working_counter(frame, *datagram, static_cast<std::uint16_t>(datagram->working_counter - 1));
}

void EscRing::plan(RingEvent event) { planned_.emplace(event.time, event); }

void EscRing::carry_out(const RingEvent& event) {
  switch (event.kind) {
    case RingEvent::Kind::cut_cable: return cut_cable(event.slave);
    case RingEvent::Kind::join_cable: return join_cable(event.slave);
    case RingEvent::Kind::power_off: return power_off(event.slave);
    case RingEvent::Kind::power_on: return power_on(event.slave, now_);
  }
}

void EscRing::on_time(TimePoint now) {
  now_ = std::max(now_, now);
  while (!planned_.empty() && planned_.begin()->first <= now_) {
    carry_out(planned_.begin()->second);
    planned_.erase(planned_.begin());
  }
  for (auto& place : slaves_)
    if (place.powered) place.slave->on_time(now_);
}

std::optional<Bytes> EscRing::take_frame() {
  if (returning_.empty() || now_ < returning_.front().due) return std::nullopt;
  auto out = std::move(returning_.front().frame);
  returning_.pop_front();
  return out;
}

TimePoint EscRing::deadline() const {
  auto next = returning_.empty() ? kNever : returning_.front().due;
  if (!planned_.empty()) next = std::min(next, planned_.begin()->first);
  for (const auto& place : slaves_)
    if (place.powered) next = std::min(next, place.slave->deadline());
  return next;
}

}  // namespace servoctl::sim
