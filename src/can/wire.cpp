#include "can/wire.hpp"

namespace servoctl::can {
namespace {

/// Counts bits as they are sent from start of frame to the end of the checksum: a bit of the other level is
/// stuffed in after five equal ones (ISO 11898-1, 10.5).
class BitCounter {
 public:
  void add(std::uint32_t value, unsigned width) {
    for (unsigned i = width; i-- > 0;) {
      const bool bit = (value >> i & 1U) != 0;
      add_to_checksum(bit);
      add_level(bit);
    }
  }
  void add_checksum() {
    const auto checksum = checksum_;
    for (unsigned i = 15; i-- > 0;) add_level((checksum >> i & 1U) != 0);
  }
  std::uint32_t count() const { return count_; }

 private:
  void add_level(bool bit) {
    ++count_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ < 5) return;
    ++count_;
    last_ = !bit;
    run_ = 1;
  }
  void add_to_checksum(bool bit) {
    const bool next = bit != ((checksum_ & 0x4000U) != 0);
    checksum_ = checksum_ << 1U & 0x7FFFU;
    if (next) checksum_ ^= 0x4599U;
  }

  std::uint32_t count_ = 0;
  std::uint32_t checksum_ = 0;
  unsigned run_ = 0;
  bool last_ = true;  ///< The bus is recessive before a frame.
};

}  // namespace

std::uint32_t bits_on_wire(const Frame& frame) {
  if (frame.error) return 0;
  // Delimiter of the checksum, acknowledge and its delimiter, end of frame, intermission.
  constexpr std::uint32_t kUnstuffed = 1 + 2 + 7 + 3;
  const auto remote = static_cast<std::uint32_t>(frame.remote);
  BitCounter bits;
  bits.add(0, 1);
  if (frame.extended) {
    bits.add(frame.id >> 18U, 11);
    bits.add(3, 2);
    bits.add(frame.id & 0x3'FFFFU, 18);
    bits.add(remote << 2U, 3);
  } else {
    bits.add(frame.id, 11);
    bits.add(remote << 2U, 3);
  }
  bits.add(frame.size, 4);
  for (const auto byte : frame.payload()) bits.add(byte, 8);
  bits.add_checksum();
  return bits.count() + kUnstuffed;
}

}  // namespace servoctl::can
