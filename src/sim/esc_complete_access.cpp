#include "sim/esc_complete_access.hpp"

#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

namespace {

constexpr std::size_t kCountSize = 2;
/// EtherCAT's own: complete access of an object whose length varies.
constexpr std::uint32_t kVariableLength = 0x0601'0004;

}  // namespace

/// In the data; 0 for one whose length varies.
std::size_t EscCompleteAccess::size_of(const od::Entry& entry) const {
  const auto size = od::size_of(entry.type).value_or(0);
  return size != 0 && entry.address.sub == 0 ? kCountSize : size;
}

std::uint32_t EscCompleteAccess::read(std::uint16_t index, std::uint8_t from, Bytes& out) {
  const auto* object = profile_->dictionary.object(index);
  if (object == nullptr) return abort::kNoObject;
  if (object->code == od::ObjectCode::var) return abort::kUnsupportedAccess;
  for (const auto& entry : object->entries) {
    const auto size = size_of(entry);
    if (entry.address.sub < from) continue;
    if (size == 0) return kVariableLength;
    Bytes value;
    if (const auto code = store_->read(entry.address, value); code != 0) return code;
    value.resize(size);
    out.insert(out.end(), value.begin(), value.end());
  }
  return 0;
}

std::uint32_t EscCompleteAccess::write(std::uint16_t index, std::uint8_t from, ByteSpan data) {
  const auto* object = profile_->dictionary.object(index);
  if (object == nullptr) return abort::kNoObject;
  if (object->code == od::ObjectCode::var) return abort::kUnsupportedAccess;
  std::size_t all = 0;
  for (const auto& entry : object->entries) {
    if (entry.address.sub < from) continue;
    if (size_of(entry) == 0) return kVariableLength;
    all += size_of(entry);
  }
  if (data.size() > all) return abort::kTooLong;
  for (const auto& entry : object->entries) {
    const auto size = size_of(entry);
    if (entry.address.sub < from) continue;
    if (data.size() < size) return data.empty() ? 0 : abort::kTooShort;
    const auto value = data.first(entry.address.sub == 0 ? 1 : size);
    if (const auto code = store_->write(entry.address, value); code != 0) return code;
    data = data.subspan(size);
  }
  return 0;
}

}  // namespace servoctl::sim
