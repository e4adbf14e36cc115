#include "sim/lss_slave.hpp"

#include <array>

#include "base/bytes.hpp"
#include "canopen/node_id.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

using canopen::kUnconfigured;
using canopen::LssState;

constexpr int kNumbers = 4;  ///< Of an identity.

bool is_node(std::uint8_t node) {
  return (node >= canopen::kFirstNode && node <= canopen::kLastNode) || node == kUnconfigured;
}

std::array<std::uint32_t, kNumbers> numbers_of(const canopen::LssAddress& address) {
  return {address.vendor, address.product, address.revision, address.serial};
}

}  // namespace

void LssSlave::restart() {
  state_ = LssState::waiting;
  pending_ = model_->node();
  selected_ = identified_ = position_ = 0;
  starts_ = false;
}

canopen::LssAddress LssSlave::address() const {
  const auto number = [&](ObjectAddress object) {
    return model_->values().has(object) ? static_cast<std::uint32_t>(model_->values().number(object)) : 0U;
  };
  return {number(objects::kVendorId), number(objects::kProductCode), number(objects::kRevision),
          model_->serial().value_or(number(objects::kSerialNumber))};
}

bool LssSlave::is_unconfigured() const {
  return model_->node() == kUnconfigured && pending_ == kUnconfigured;
}

std::optional<can::Frame> LssSlave::take_frame() {
  if (tx_.empty()) return std::nullopt;
  const auto frame = tx_.front();
  tx_.pop_front();
  return frame;
}

void LssSlave::answer(Service service, std::uint32_t value) {
  std::array<std::uint8_t, 8> data{};
  data[0] = static_cast<std::uint8_t>(service);
  store_le(value, std::span(data).subspan(1, 4));
  tx_.push_back(can::make_frame(canopen::kLssAnswer, data));
}

void LssSlave::on_frame(const can::Frame& frame) {
  if (frame.id != canopen::kLssRequest || frame.extended || frame.error || frame.remote || frame.size != 8)
    return;
  const auto service = static_cast<Service>(frame.data[0]);
  const auto number = static_cast<std::uint32_t>(load_le(std::span(frame.data).subspan(1, 4)));
  const bool waits = state_ == LssState::waiting;
  if (service == Service::switch_all) return switch_to(frame.data[1]);
  if (service >= Service::identify_vendor && service <= Service::identify_serial_high)
    return on_identify(service, number);
  if (service == Service::identify_unconfigured) {
    if (is_unconfigured()) answer(Service::unconfigured);
    return;
  }
  if (!waits) return on_configuration(service, frame);
  if (service >= Service::select_vendor && service <= Service::select_serial)
    return on_select(service, number);
  if (service == Service::fastscan) on_fastscan(frame);
}

void LssSlave::switch_to(std::uint8_t state) {
  if (state > 1) return;
  const bool leaves = state_ == LssState::configuration && state == 0;
  state_ = static_cast<LssState>(state);
  selected_ = 0;
  if (leaves && model_->node() == kUnconfigured && pending_ != kUnconfigured) starts_ = true;
}

/// In their order: one that does not fit, or comes out of turn, begins anew.
void LssSlave::on_select(Service service, std::uint32_t number) {
  const int place = static_cast<int>(service) - static_cast<int>(Service::select_vendor);
  if (place == 0) selected_ = 0;
  if (place != selected_ || number != numbers_of(address())[static_cast<std::size_t>(place)]) {
    selected_ = 0;
    return;
  }
  if (++selected_ < kNumbers) return;
  selected_ = 0;
  state_ = LssState::configuration;
  answer(Service::selected);
}

void LssSlave::on_identify(Service service, std::uint32_t number) {
  const int place = static_cast<int>(service) - static_cast<int>(Service::identify_vendor);
  const auto own = address();
  const bool fits[] = {number == own.vendor,   number == own.product, number <= own.revision,
                       number >= own.revision, number <= own.serial,  number >= own.serial};
  if (place == 0) identified_ = 0;
  if (place != identified_ || !fits[place]) {
    identified_ = 0;
    return;
  }
  if (++identified_ < 6) return;
  identified_ = 0;
  answer(Service::identified);
}

void LssSlave::on_fastscan(const can::Frame& frame) {
  if (!is_unconfigured()) return;
  const auto number = static_cast<std::uint32_t>(load_le(std::span(frame.data).subspan(1, 4)));
  const int bit = frame.data[5], part = frame.data[6], next = frame.data[7];
  if (bit == canopen::kFastscanBegin) {
    position_ = 0;
    return answer(Service::identified);
  }
  if (bit > 31 || part >= kNumbers || next >= kNumbers || part != position_) return;
  const auto own = numbers_of(address())[static_cast<std::size_t>(part)];
  if ((own ^ number) >> static_cast<unsigned>(bit) != 0) return;
  position_ = next;
  if (bit == 0 && next < part) state_ = LssState::configuration;
  answer(Service::identified);
}

void LssSlave::on_configuration(Service service, const can::Frame& frame) {
  switch (service) {
    case Service::set_node: {
      const bool good = is_node(frame.data[1]);
      if (good) pending_ = frame.data[1];
      return answer(service, good ? 0 : 1);
    }
    case Service::set_bit_timing:
      return answer(service, frame.data[1] == 0 && canopen::lss_bitrate(frame.data[2]) ? 0 : 1);
    case Service::store: return answer(service, model_->store_node(pending_) ? 0 : 2);
    default: return on_inquiry(service);
  }
}

void LssSlave::on_inquiry(Service service) {
  const int place = static_cast<int>(service) - static_cast<int>(Service::inquire_vendor);
  if (place >= 0 && place < kNumbers) answer(service, numbers_of(address())[static_cast<std::size_t>(place)]);
  // Before it has one, the node-ID that it is to have.
  if (service == Service::inquire_node)
    answer(service, model_->node() == kUnconfigured ? pending_ : model_->node());
}

}  // namespace servoctl::sim
