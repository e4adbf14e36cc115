#include "traffic/recording_summary.hpp"

#include <algorithm>
#include <chrono>
#include <variant>

#include "canopen/cob_id.hpp"
#include "canopen/emergency.hpp"
#include "canopen/error_control.hpp"
#include "canopen/nmt.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::traffic {
namespace {

using SdoKind = canopen::SdoStep::Kind;

/// A request at the end of a recording may still have been answered.
constexpr Duration kStillOpen = std::chrono::seconds(1);

}  // namespace

RecordingSummary::RecordingSummary(const show::Desk& desk,
                                   const std::map<std::uint8_t, const drive::Profile*>& families)
    : desk_(&desk),
      own_families_(&families),
      decoder_(
          {.profile = desk.profile, .standard = desk.standard, .chinese = desk.chinese, .fields = false}) {
  for (const auto& [node, profile] : families) decoder_.set_family(node, profile);
}

const drive::Profile* RecordingSummary::family_of(std::uint8_t node) const {
  const auto own = own_families_->find(node);
  return own == own_families_->end() ? desk_->profile : own->second;
}

void RecordingSummary::Times::add(Duration time) {
  if (count++ == 0) first = time;
  last = time;
}

void RecordingSummary::add(Duration time, const can::Frame& frame) {
  if (frames_++ == 0) begin_ = last_ = time;
  if (time - last_ > gap_) {
    gap_ = time - last_;
    gap_at_ = last_;
  }
  last_ = time;
  const auto& decoded = decoder_.decode(frame);
  ++services_[decoded.service];
  if (decoded.service == "sync" || (decoded.service == "pdo" && !frame.remote)) {
    auto& cycle = cycles_[canopen::can_id_of(frame)];
    const auto* view = decoded.service == "pdo" ? decoder_.pdos().find(canopen::can_id_of(frame)) : nullptr;
    cycle.name = decoded.service == "sync" ? "SYNC" : view != nullptr ? view->name : "PDO";
    cycle.node = decoded.node;
    cycle.rhythm.add(TimePoint(time));
  }
  if (!decoded.node) return;
  const auto id = *decoded.node;
  if (decoded.service != "nmt") ++nodes_[id].frames;
  if (decoded.service == "emcy")
    if (const auto emergency = canopen::parse_emergency(frame, id))
      emergencies_[{id, emergency->code}].add(time);
  if (decoded.service == "sdo") add_sdo(time, frame, id);
  add_state(frame, decoded);
}

/// What it tells of its states.
void RecordingSummary::add_state(const can::Frame& frame, const DecodedFrame& decoded) {
  auto& node = nodes_[*decoded.node];
  if (decoded.service == "boot-up" || decoded.service == "heartbeat")
    if (const auto message = canopen::parse_error_control(frame)) {
      node.boot_ups += message->boot_up;
      node.nmt = message->boot_up ? "boot-up" : canopen::name(message->state);
      if (!message->boot_up) node.heartbeats.add(TimePoint(last_));
      if (message->boot_up) node.statusword.reset();
    }
  if (decoded.service != "pdo" || frame.remote) return;
  const auto* view = decoder_.pdos().find(canopen::can_id_of(frame));
  if (view == nullptr || !show::shows_values(*view, frame.payload())) return;
  for (const auto& field : view->fields)
    if (field.entry.object == objects::kStatusword)
      if (const auto value = field.value(frame.payload());
          const auto* word = std::get_if<std::uint64_t>(&value))
        node.statusword = static_cast<std::uint16_t>(*word);
}

/// A request that was not answered before the next one, or that its client gave up.
void RecordingSummary::miss(std::uint8_t id) {
  if (!open_[id]) return;
  unanswered_[{id, open_[id]->object}].add(open_[id]->time);
  ++nodes_[id].unanswered;
  open_[id].reset();
}

void RecordingSummary::end() {
  for (std::size_t id = 0; id < open_.size(); ++id)
    if (open_[id] && last_ - open_[id]->time > kStillOpen) miss(static_cast<std::uint8_t>(id));
}

void RecordingSummary::add_sdo(Duration time, const can::Frame& frame, std::uint8_t id) {
  const bool asked = frame.id > canopen::kSdoRequest;
  auto& channel = channels_[id];
  const auto step = asked ? channel.on_client_frame(frame) : channel.on_server_frame(frame);
  if (step.kind == SdoKind::abort) {
    aborts_[{id, step.object.value_or(ObjectAddress{}), step.abort_code}].add(time);
    ++nodes_[id].aborts;
  }
  if (asked) {
    miss(id);
    const bool request = step.kind == SdoKind::read || step.kind == SdoKind::write;
    if (request && step.object) open_[id] = Request{*step.object, time};
    return;
  }
  if (open_[id])
    nodes_[id].slowest_ms = std::max(
        nodes_[id].slowest_ms, std::chrono::duration<double, std::milli>(time - open_[id]->time).count());
  open_[id].reset();
  if (step.object == objects::kStatusword && step.data && step.data->size() == 2)
    nodes_[id].statusword = static_cast<std::uint16_t>(load_le(*step.data));
}

}  // namespace servoctl::traffic
