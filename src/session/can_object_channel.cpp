#include "session/can_object_channel.hpp"

#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

/// Of a controlword with which the motor does not go on: all but "enable operation" without halt (CiA 402-2,
/// bit 8), and the reset of a fault.
bool slows_down(ByteSpan controlword) {
  constexpr std::uint16_t kHalt = 0x0100;
  if (controlword.empty() || controlword.size() > 2) return false;
  const auto word = static_cast<std::uint16_t>(load_le(controlword));
  const auto command = drive::decode_command(word, 0);
  return (word & kHalt) != 0 || (command != drive::ControlCommand::enable_operation &&
                                 command != drive::ControlCommand::fault_reset);
}

}  // namespace

CanObjectChannel::CanObjectChannel(CanNetwork& network, std::uint8_t node, Duration timeout)
    : network_(&network),
      client_(node, timeout),
      next_(std::exchange(network.channels_[node & 0x7FU], this)) {
  client_.adopt(next_ != nullptr ? next_->client_.open_requests() : network.open_requests_[node & 0x7FU]);
}

CanObjectChannel::~CanObjectChannel() {
  auto** place = &network_->channels_[client_.node() & 0x7FU];
  while (*place != this) place = &(*place)->next_;
  *place = next_;
  network_->open_requests_[client_.node() & 0x7FU] = client_.open_requests();
}

Result<void> CanObjectChannel::on_time(TimePoint now) {
  if (client_.deadline() <= now) client_.on_time(now);
  while (client_.may_send()) {
    const auto frame = client_.take_frame();
    if (!frame) break;
    if (auto sent = network_->send(*frame); !sent) return sent;
    for (auto* other = network_->channels_[client_.node() & 0x7FU]; other != nullptr; other = other->next_)
      if (other != this) other->client_.overhear(*frame, now);
  }
  stirred_ = false;
  return {};
}

void CanObjectChannel::start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                                    std::size_t size) {
  object_ = object;
  emergency_id_.reset();
  stirred_ = true;
  client_.start_upload(object, now, transfer, size, std::exchange(again_, false));
}

void CanObjectChannel::start_download(ObjectAddress object, Bytes data, TimePoint now,
                                      canopen::Transfer transfer) {
  object_ = object;
  emergency_id_.reset();
  stirred_ = true;
  if (data.size() == 4) emergency_id_ = static_cast<std::uint32_t>(load_le(data));
  const bool waits_for_nothing = object == objects::kControlword && slows_down(data);
  client_.start_download(object, std::move(data), now, transfer);
  if (waits_for_nothing) client_.go_at_once(now);
}

std::optional<Result<Bytes>> CanObjectChannel::take_result() {
  auto result = client_.take_result();
  const auto habits = client_.take_habits();
  for (std::size_t i = 0; habits.any() && i < habits.size(); ++i)
    if (habits.test(i)) network_->tell_habit(client_.node(), static_cast<canopen::SdoHabit>(i));
  if (!result || !*result || object_ != objects::kEmergencyCobId) return result;
  if ((*result)->size() == 4) emergency_id_ = static_cast<std::uint32_t>(load_le(**result));
  if (emergency_id_) network_->watch_.learn_emergency_id(client_.node(), *emergency_id_);
  return result;
}

}  // namespace servoctl::session
