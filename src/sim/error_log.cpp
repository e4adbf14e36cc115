#include "sim/error_log.hpp"

#include <utility>

namespace servoctl::sim {
namespace {

enum Bit : std::uint8_t {
  kGeneric = 0x01,
  kCurrent = 0x02,
  kVoltage = 0x04,
  kTemperature = 0x08,
  kCommunication = 0x10,
  kProfile = 0x20,
  kManufacturer = 0x80,
};

/// The bit that goes with an error code: 81xxh and 82xxh are errors of the communication, the other codes of
/// monitoring are the profile's (CiA 402-2, following error 8611h).
std::uint8_t class_of(std::uint16_t code) {
  if (code >= 0xFF00) return kManufacturer;
  switch (code >> 12U) {
    case 0x2: return kCurrent;
    case 0x3: return kVoltage;
    case 0x4: return kTemperature;
    case 0x8: return code < 0x8300 ? kCommunication : kProfile;
    default: return 0;
  }
}

}  // namespace

void ErrorLog::begin(Source source, std::uint16_t code, std::uint16_t additional) {
  present_[place(source)] = code;
  history_.push_front(static_cast<std::uint32_t>(additional) << 16U | code);
  if (history_.size() > capacity_) history_.pop_back();
}

bool ErrorLog::end(Source source) { return std::exchange(present_[place(source)], std::nullopt).has_value(); }

std::uint8_t ErrorLog::error_register() const {
  std::uint8_t out = 0;
  for (const auto& code : present_)
    if (code) out = static_cast<std::uint8_t>(out | kGeneric | class_of(*code));
  return out;
}

}  // namespace servoctl::sim
