#include "sim/esc_coe.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::sim {
namespace {

constexpr std::size_t kCoeHead = 2;  ///< Number and service.
constexpr std::size_t kSdoSize = 8;
constexpr std::size_t kInfoSize = 6;

enum Service : std::uint8_t { kEmergency = 1, kSdoRequest = 2, kSdoResponse = 3, kSdoInfo = 8 };

/// Details of a mailbox error (ETG.1000.4, table 30).
constexpr std::uint16_t kServiceError = 4;
constexpr std::uint16_t kTooShort = 6;

Bytes message(unsigned service, ByteSpan data) {
  Bytes out = store_le(service << 12U, kCoeHead);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

}  // namespace

Bytes EscCoe::emergency(const Emergency& emergency) {
  Bytes data = store_le(emergency.code, 2);
  data.push_back(emergency.error_register);
  data.insert(data.end(), emergency.vendor.begin(), emergency.vendor.end());
  return message(kEmergency, data);
}

EscCoe::Answer EscCoe::on_request(ByteSpan request, std::size_t most) {
  if (request.size() < kCoeHead + kInfoSize) return {{}, kTooShort};
  const auto service = load_le(request.first(kCoeHead)) >> 12U;
  const auto data = request.subspan(kCoeHead);
  Answer out;
  if (faults_->emergencies > 0) {
    --faults_->emergencies;
    out.messages.push_back(emergency({0xFF00, 0, {}}));
  }
  if (service == kSdoRequest) {
    if (data.size() < kSdoSize) return {{}, kTooShort};
    const Bytes asked(data.begin(), data.begin() + 4);
    if (asleep_ && asked == Bytes{0x40, 0x41, 0x60, 0x00}) {
      out.messages.push_back(message(kSdoResponse, Bytes{0x4B, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
      return out;
    }
    auto answer = server_.on_request(data, most - kCoeHead);
    const auto as = answer && answer->abort ? options_.abort_service : std::uint8_t{kSdoResponse};
    if (answer) out.messages.push_back(message(as, answer->message));
    return out;
  }
  if (service != kSdoInfo || !options_.sdo_info) return {{}, kServiceError};
  for (const auto& piece : info_.on_request(data, most - kCoeHead))
    out.messages.push_back(message(kSdoInfo, piece));
  return out;
}

}  // namespace servoctl::sim
