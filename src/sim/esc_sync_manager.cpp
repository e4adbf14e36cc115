#include "sim/esc_sync_manager.hpp"

#include <algorithm>
#include <utility>

#include "ethercat/registers.hpp"

namespace servoctl::sim {
namespace reg = ethercat::reg;

namespace {

enum Offset : unsigned { kStart, kStartHigh, kLength, kLengthHigh, kControl, kStatus, kActivate, kProcessor };

/// Of three buffers none was written yet (status, bits 4 and 5).
constexpr std::uint8_t kNothingWritten = 0x30;

std::uint16_t with_byte(std::uint16_t word, unsigned byte, std::uint8_t value) {
  const auto shift = 8U * byte;
  return static_cast<std::uint16_t>((word & ~(0xFFU << shift)) | unsigned{value} << shift);
}

}  // namespace

std::uint8_t EscSyncManager::register_at(unsigned offset) const {
  switch (offset) {
    case kStart:
    case kStartHigh: return static_cast<std::uint8_t>(start_ >> 8U * offset);
    case kLength:
    case kLengthHigh: return static_cast<std::uint8_t>(length_ >> 8U * (offset - kLength));
    case kControl: return control_;
    case kStatus:
      if (is_mailbox()) return full_ ? reg::kSmFull : 0;
      return begun_ ? 0 : kNothingWritten;
    case kActivate:
      return static_cast<std::uint8_t>((enabled_ ? reg::kSmEnable : 0U) | (repeat_ ? reg::kSmRepeat : 0U));
    case kProcessor: return repeated_ ? reg::kSmRepeatDone : std::uint8_t{0};
    default: return 0;
  }
}

bool EscSyncManager::write_register(unsigned offset, std::uint8_t value) {
  if (offset == kStatus || offset == kProcessor) return false;
  if (offset == kActivate) {
    const bool enable = (value & reg::kSmEnable) != 0;
    repeat_ = (value & reg::kSmRepeat) != 0;
    if (enable != std::exchange(enabled_, enable)) clear();
    return true;
  }
  if (enabled_) return false;
  if (offset <= kStartHigh) start_ = with_byte(start_, offset, value);
  if (offset == kLength || offset == kLengthHigh) length_ = with_byte(length_, offset - kLength, value);
  if (offset == kControl) control_ = value;
  return true;
}

void EscSyncManager::reset() { *this = EscSyncManager(); }

/// All that was under way is gone; what the repeat bits say stays.
void EscSyncManager::clear() {
  full_ = open_ = begun_ = written_ = read_ = false;
  filling_.assign(length_, 0);
  whole_.assign(length_, 0);
  reading_.assign(length_, 0);
}

bool EscSyncManager::read(std::uint32_t offset, std::span<std::uint8_t> out) {
  if (master_writes() || (is_mailbox() && !full_)) return false;
  if (offset == 0) {
    open_ = true;
    reading_ = whole_;
  }
  if (!open_) return false;
  std::copy_n(reading_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
  if (offset + out.size() < length_) return true;
  open_ = false;
  full_ = false;
  read_ = true;
  return true;
}

bool EscSyncManager::write(std::uint32_t offset, ByteSpan data) {
  if (!master_writes() || (is_mailbox() && full_)) return false;
  if (offset == 0) open_ = true;
  if (!open_) return false;
  std::copy(data.begin(), data.end(), filling_.begin() + static_cast<std::ptrdiff_t>(offset));
  if (offset + data.size() < length_) return true;
  open_ = false;
  full_ = is_mailbox();
  begun_ = true;
  whole_ = filling_;
  written_ = true;
  return true;
}

const Bytes& EscSyncManager::take() {
  full_ = false;
  return whole_;
}

void EscSyncManager::put(ByteSpan data) {
  whole_.assign(length_, 0);
  std::copy_n(data.begin(), std::min<std::size_t>(data.size(), length_), whole_.begin());
  full_ = is_mailbox();
  begun_ = true;
  open_ = open_ && !is_mailbox();
}

Bytes EscSyncManager::recall() {
  full_ = false;
  open_ = false;
  return whole_;
}

bool EscSyncManager::take_written() { return std::exchange(written_, false); }

bool EscSyncManager::take_read() { return std::exchange(read_, false); }

}  // namespace servoctl::sim
