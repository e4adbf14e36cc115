#include "sim/pdo_engine.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;

constexpr std::uint8_t kLastSynchronous = 240;
constexpr std::uint8_t kBySyncAndRequest = 252;
constexpr std::uint8_t kByRequest = 253;
constexpr std::uint8_t kFirstEvent = 254;
/// How often a drive compares what an event-driven TPDO carries with what it last sent.
constexpr Duration kCycle = std::chrono::milliseconds(1);

}  // namespace

PdoEngine::PdoEngine(const drive::Profile& profile, const ObjectValues& values, canopen::ObjectStore& store)
    : profile_(&profile), values_(&values), store_(&store) {
  for (const auto& object : profile.dictionary.objects())
    if (const auto place = canopen::pdo_at(object.index); place && !place->mapping)
      known_.push_back({place->direction, place->number});
}

Pdo PdoEngine::read_pdo(PdoDirection direction, std::uint16_t number) const {
  Pdo out{direction, number};
  const auto record = out.communication_index();
  const auto at = [&](std::uint8_t sub) { return values_->number({record, sub}); };
  out.cob_id = static_cast<std::uint32_t>(at(1));
  out.type = static_cast<std::uint8_t>(at(2));
  out.inhibit = static_cast<std::uint16_t>(at(3));
  out.event = static_cast<std::uint16_t>(at(5));
  out.sync_start = static_cast<std::uint8_t>(at(6));
  const auto mapping = out.mapping_index();
  const auto count = std::min<std::uint64_t>(values_->number({mapping, 0}), 64);
  for (std::uint8_t sub = 1; sub <= count; ++sub)
    out.entries.push_back(
        canopen::parse_pdo_entry(static_cast<std::uint32_t>(values_->number({mapping, sub}))));
  return out;
}

void PdoEngine::start(TimePoint now) {
  if (operational_) return;
  operational_ = true;
  work_.clear();
  next_look_ = now;
  on_time(now);
}

void PdoEngine::stop() {
  operational_ = false;
  next_look_ = kNever;
  work_.clear();
  short_.clear();
  long_.clear();
  tx_.clear();
}

void PdoEngine::on_frame(const can::Frame& frame, TimePoint now) {
  synchronous_.clear();
  if (!operational_ || frame.error) return;
  if (frame.remote) return on_request(frame, now);
  const auto sync = static_cast<std::uint32_t>(values_->number(objects::kSyncCobId)) & canopen::kPdoCobIdMask;
  if (!frame.extended && frame.id == (sync == 0 ? canopen::kSync : sync)) return on_sync(frame, now);
  for (const auto& known : known_) {
    if (known.direction != PdoDirection::receive) continue;
    const auto pdo = read_pdo(known.direction, known.number);
    if (pdo.is_valid() && pdo.can_id() == canopen::can_id_of(frame)) on_receive(pdo, frame);
  }
}

void PdoEngine::on_request(const can::Frame& frame, TimePoint now) {
  for (const auto& known : known_) {
    if (known.direction != PdoDirection::transmit) continue;
    const auto pdo = read_pdo(known.direction, known.number);
    const bool answers = pdo.is_valid() && (pdo.cob_id & canopen::kPdoNoRtr) == 0 && !pdo.entries.empty();
    if (answers && pdo.can_id() == canopen::can_id_of(frame)) on_request(pdo, now);
  }
}

void PdoEngine::on_request(const Pdo& pdo, TimePoint now) {
  auto& state = work(pdo);
  if (pdo.type == kByRequest) return transmit(pdo, sample(pdo), now);
  if (pdo.type == kBySyncAndRequest) {
    state.requested = profile_->rules.pdo.answers_at_sync(pdo.type);
    if (!state.requested && state.data) transmit(pdo, *state.data, now);
    return;
  }
  if (pdo.type < kFirstEvent) return;
  state.requested = true;
  check_events(pdo, now);
}

void PdoEngine::on_receive(const Pdo& pdo, const can::Frame& frame) {
  if (pdo.entries.empty()) return;
  auto data = frame.payload();
  const auto size = (pdo.bits() + 7) / 8;
  const auto note = [&](std::set<std::uint16_t>& records, bool wrong) {
    if (wrong)
      records.insert(pdo.communication_index());
    else
      records.erase(pdo.communication_index());
  };
  note(short_, data.size() < size);
  note(long_, data.size() > size);
  if (data.size() < size) return;
  data = data.first(size);
  if (pdo.type <= kLastSynchronous)
    work(pdo).data = Bytes(data.begin(), data.end());
  else
    apply(pdo, data);
}

void PdoEngine::on_sync(const can::Frame& frame, TimePoint now) {
  const auto counter = frame.size > 0 ? std::optional(frame.data[0]) : std::nullopt;
  // What came before the SYNC is taken over before anything is sampled.
  for (const auto direction : {PdoDirection::receive, PdoDirection::transmit})
    for (const auto& known : known_) {
      if (known.direction != direction) continue;
      const auto pdo = read_pdo(direction, known.number);
      if (!pdo.is_valid()) continue;
      if (pdo.type <= kLastSynchronous) on_sync(pdo, counter, now);
      if (pdo.type == kBySyncAndRequest) on_sync_by_request(pdo, now);
    }
}

void PdoEngine::on_sync_by_request(const Pdo& pdo, TimePoint now) {
  auto& state = work(pdo);
  auto data = sample(pdo);
  if (state.requested)
    transmit(pdo, std::move(data), now);
  else
    state.data = std::move(data);
}

void PdoEngine::on_sync(const Pdo& pdo, std::optional<std::uint8_t> counter, TimePoint now) {
  auto& state = work(pdo);
  if (pdo.direction == PdoDirection::receive) {
    const auto data = std::exchange(state.data, std::nullopt);
    if (!data) return;
    apply(pdo, *data);
    for (const auto& entry : pdo.entries) synchronous_.insert(entry.object);
    return;
  }
  if (pdo.entries.empty()) return;
  auto data = sample(pdo);
  if (pdo.type == 0) {
    if (!state.data || *state.data != data) transmit(pdo, std::move(data), now);
    return;
  }
  const bool starts = counter && pdo.sync_start.value_or(0) != 0 && !state.started;
  if (starts && *counter != *pdo.sync_start) return;
  // With a start value, the SYNC that carries it is the first to be answered (CiA 301, 7.5.2.37).
  const bool first = std::exchange(state.started, true) == false && starts;
  if (++state.syncs >= pdo.type || first) transmit(pdo, std::move(data), now);
}

void PdoEngine::on_time(TimePoint now) {
  if (!operational_ || now < next_look_) return;
  next_look_ = kNever;
  for (const auto& known : known_) {
    if (known.direction != PdoDirection::transmit) continue;
    const auto pdo = read_pdo(known.direction, known.number);
    if (pdo.type < kFirstEvent) continue;
    if (pdo.is_valid() && !pdo.entries.empty())
      check_events(pdo, now);
    else
      work(pdo) = {};
  }
  next_look_ = now + kCycle;
}

void PdoEngine::check_events(const Pdo& pdo, TimePoint now) {
  auto& state = work(pdo);
  const auto inhibit = pdo.inhibit.value_or(0) * std::chrono::microseconds(100);
  if (state.sent && now < *state.sent + inhibit) return;
  const auto& rules = profile_->rules.pdo;
  const auto timer = std::chrono::milliseconds(pdo.event.value_or(0));
  const bool timed = rules.sends_by_timer(pdo.type) && timer > Duration::zero();
  const bool due = state.requested || (timed && (!state.sent || now >= *state.sent + timer));
  const bool watched = rules.sends_on_change(pdo.type);
  if (!due && !watched) return;
  auto data = sample(pdo);
  if (due || !state.data || *state.data != data) transmit(pdo, std::move(data), now);
}

/// What an object does not take is not taken; the others are.
void PdoEngine::apply(const Pdo& pdo, ByteSpan data) {
  const auto values = canopen::unpack_pdo(pdo.entries, data);
  for (std::size_t i = 0; values && i < values->size(); ++i)
    if (!pdo.entries[i].is_gap()) store_->write(pdo.entries[i].object, (*values)[i]);
}

Bytes PdoEngine::sample(const Pdo& pdo) {
  std::vector<Bytes> values(pdo.entries.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!pdo.entries[i].is_gap()) (void)store_->read(pdo.entries[i].object, values[i]);
  return canopen::pack_pdo(pdo.entries, values);
}

void PdoEngine::transmit(const Pdo& pdo, Bytes data, TimePoint now) {
  auto& state = work(pdo);
  state.syncs = 0;
  state.sent = now;
  state.requested = false;
  auto frame = can::make_frame(pdo.cob_id & canopen::kPdoCobIdMask, data);
  frame.extended = (pdo.cob_id & canopen::kPdoExtended) != 0;
  tx_.push_back(frame);
  state.data = std::move(data);
}

std::optional<can::Frame> PdoEngine::take_frame() {
  if (tx_.empty()) return std::nullopt;
  const auto frame = tx_.front();
  tx_.pop_front();
  return frame;
}

TimePoint PdoEngine::deadline() const {
  if (!tx_.empty()) return TimePoint::min();
  return next_look_;
}

}  // namespace servoctl::sim
