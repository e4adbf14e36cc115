#include "ethercat/ring.hpp"

#include <algorithm>

namespace servoctl::ethercat {
namespace {

/// Slaves count the position of these up or put their own address there (ETG.1000.4, 5.4.1).
bool address_returns(Command command) {
  switch (command) {
    case Command::fprd:
    case Command::fpwr:
    case Command::fprw:
    case Command::frmw:
    case Command::lrd:
    case Command::lwr:
    case Command::lrw: return true;
    default: return false;
  }
}

/// One slave does it, or nobody.
bool is_for_one(Command command) { return command >= Command::aprd && command <= Command::fprw; }

/// What one slave adds to the working counter: 1 for each of reading and writing, 3 for both
/// (ETG.1000.4, 5.4).
std::uint16_t counter_of_one(Command command) {
  if (!is_for_one(command)) return 0;
  return command == Command::aprw || command == Command::fprw ? 3 : 1;
}

}  // namespace

Ring::Ring(const Options& options) : options_(options) {
  options_.frames_in_flight = std::clamp<std::size_t>(options_.frames_in_flight, 1, kMaxFlights);
  urgent_.reserve(slots_.size());
  waiting_.reserve(slots_.size());
}

std::optional<std::uint8_t> Ring::free_slot() {
  for (std::size_t tries = 0; tries < slots_.size(); ++tries) {
    const auto index = next_++;
    if (slots_[index].state == State::free) return index;
  }
  return std::nullopt;
}

std::optional<Ring::Ticket> Ring::post(Command command, std::uint32_t address, ByteSpan data,
                                       const Post& how) {
  if (data.size() > kMaxDatagramData) return std::nullopt;
  const auto index = free_slot();
  if (!index) return std::nullopt;
  auto& slot = slots_[*index];
  slot.generation = (slot.generation + 1) & 0x00FF'FFFFU;
  slot.abandoned = false;
  slot.command = command;
  slot.address = address;
  slot.data.assign(data.begin(), data.end());
  slot.how = how;
  slot.repeats = how.repeatable ? options_.repeats : 0;
  enqueue(*index);
  return slot.generation << 8U | *index;
}

std::optional<Ring::Ticket> Ring::post(const Request& request) {
  Post how;
  how.repeatable = request.repeatable;
  return post(request.command, request.address, request.data, how);
}

void Ring::enqueue(std::uint8_t index) {
  slots_[index].state = State::queued;
  (slots_[index].how.urgent ? urgent_ : waiting_).push_back(index);
}

Ring::Slot* Ring::slot_of(Ticket ticket) {
  auto& slot = slots_[ticket & 0xFFU];
  return slot.state != State::free && slot.generation == ticket >> 8U ? &slot : nullptr;
}

std::optional<Answer> Ring::take_answer(Ticket ticket) {
  auto* slot = slot_of(ticket);
  if (slot == nullptr || slot->state != State::answered) return std::nullopt;
  slot->state = State::free;
  return slot->answer;
}

void Ring::forget(Ticket ticket) {
  auto* slot = slot_of(ticket);
  if (slot == nullptr) return;
  if (slot->state == State::in_flight) {
    slot->abandoned = true;
    return;
  }
  if (slot->state == State::queued) {
    const auto index = static_cast<std::uint8_t>(ticket);
    std::erase(urgent_, index);
    std::erase(waiting_, index);
  }
  slot->state = State::free;
}

std::optional<std::uint8_t> Ring::free_flight() const {
  for (std::size_t i = 0; i < flights_.size(); ++i)
    if (flights_[i].open == 0) return static_cast<std::uint8_t>(i);
  return std::nullopt;
}

bool Ring::may_send() const {
  return !urgent_.empty() || (!waiting_.empty() && flying_ < options_.frames_in_flight);
}

std::optional<ByteSpan> Ring::take_frame(TimePoint now) {
  if (!may_send()) return std::nullopt;
  const auto flight = free_flight();
  if (!flight) return std::nullopt;
  FrameWriter writer(buffer_, options_.source);
  flights_[*flight] = {0, now};
  pack(writer, urgent_, *flight, now);
  pack(writer, waiting_, *flight, now);
  ++flying_;
  ++statistics_.sent;
  return writer.finish();
}

/// In their order: one that does not fit keeps those behind it waiting.
void Ring::pack(FrameWriter& writer, std::vector<std::uint8_t>& queue, std::uint8_t flight, TimePoint now) {
  std::size_t packed = 0;
  for (; packed < queue.size(); ++packed) {
    auto& slot = slots_[queue[packed]];
    if (!writer.add(slot.command, queue[packed], slot.address, slot.data)) break;
    slot.state = State::in_flight;
    slot.flight = flight;
    slot.answer = {{}, 0, true, now, counter_of_one(slot.command)};
    ++flights_[flight].open;
    const auto timeout = slot.how.timeout > Duration{} ? slot.how.timeout : options_.timeout;
    flights_[flight].deadline = std::max(flights_[flight].deadline, now + timeout);
  }
  queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(packed));
}

bool Ring::on_frame(ByteSpan frame, TimePoint) {
  if (!is_ethercat(frame)) return false;
  auto reader = FrameReader::open(frame);
  if (!reader) {
    ++statistics_.damaged;
    return false;
  }
  bool ours = false;
  while (const auto datagram = reader->next()) {
    auto* slot = match(*datagram);
    if (slot == nullptr) {
      ++statistics_.late;
      continue;
    }
    take_in(*slot, *datagram);
    ours = true;
  }
  if (ours) ++statistics_.received;
  return ours;
}

Ring::Slot* Ring::match(const Datagram& datagram) {
  auto& slot = slots_[datagram.index];
  if (slot.state != State::in_flight || slot.command != datagram.command) return nullptr;
  if (slot.data.size() != datagram.data.size()) return nullptr;
  const auto changed = slot.address ^ datagram.address;
  const bool same = address_returns(slot.command) ? changed == 0 : (changed & 0xFFFF'0000U) == 0;
  return same ? &slot : nullptr;
}

/// What nobody did is tried again like what is lost: a slave that restarts, or is busy, may have missed it.
bool Ring::is_tried_again(const Slot& slot, const Datagram& datagram) {
  return datagram.working_counter == 0 && is_for_one(slot.command) && slot.repeats > 0 && !slot.abandoned;
}

void Ring::take_in(Slot& slot, const Datagram& datagram) {
  if (is_tried_again(slot, datagram)) return lose(datagram.index);
  std::copy(datagram.data.begin(), datagram.data.end(), slot.data.begin());
  slot.answer.data = slot.data;
  slot.answer.working_counter = datagram.working_counter;
  slot.answer.lost = false;
  if (datagram.working_counter < slot.how.expected) ++statistics_.short_counters;
  land(slot);
}

void Ring::land(Slot& slot) {
  auto& flight = flights_[slot.flight];
  if (--flight.open == 0) --flying_;
  slot.state = slot.abandoned ? State::free : State::answered;
}

void Ring::lose(std::uint8_t index) {
  auto& slot = slots_[index];
  land(slot);
  if (slot.state == State::free || slot.repeats == 0) return;
  --slot.repeats;
  ++statistics_.repeated;
  enqueue(index);
}

void Ring::on_time(TimePoint now) {
  for (std::size_t number = 0, seen = 0, flying = flying_; seen < flying; ++number) {
    if (flights_[number].open == 0) continue;
    ++seen;
    if (now < flights_[number].deadline) continue;
    ++statistics_.lost;
    for (std::size_t i = 0; i < slots_.size(); ++i)
      if (slots_[i].state == State::in_flight && slots_[i].flight == number)
        lose(static_cast<std::uint8_t>(i));
  }
}

TimePoint Ring::deadline() const {
  TimePoint out = kNever;
  for (std::size_t number = 0, seen = 0; seen < flying_; ++number) {
    if (flights_[number].open == 0) continue;
    ++seen;
    out = std::min(out, flights_[number].deadline);
  }
  return out;
}

void Carrier::leave(Ring& ring) {
  if (ticket_) ring.forget(*ticket_);
  ticket_.reset();
  request_.reset();
}

}  // namespace servoctl::ethercat
