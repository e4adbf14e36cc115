#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "base/bytes.hpp"
#include "base/result.hpp"

namespace servoctl::ethercat {

/// What a datagram asks of the slaves it passes (ETG.1000.4, 5.4): read, write or both, at a position (AP), a
/// station address (FP), all slaves (B) or a logical address (L). M: the first reads, those behind it write.
enum class Command : std::uint8_t {
  nop = 0,
  aprd = 1,
  apwr = 2,
  aprw = 3,
  fprd = 4,
  fpwr = 5,
  fprw = 6,
  brd = 7,
  bwr = 8,
  brw = 9,
  lrd = 10,
  lwr = 11,
  lrw = 12,
  armw = 13,
  frmw = 14,
};
inline constexpr std::uint8_t kLastCommand = 14;

/// `FPRD`; `unknown command` for a number that is none.
std::string_view name(Command command);
constexpr bool is_logical(Command command) { return command >= Command::lrd && command <= Command::lrw; }
/// Data flows from the slave to the master.
bool reads(Command command);
/// Data flows from the master to the slave.
bool writes(Command command);

using MacAddress = std::array<std::uint8_t, 6>;

inline constexpr std::uint16_t kEtherType = 0x88A4;
inline constexpr std::size_t kMinFrame = 60;          ///< Shorter frames are padded with zeros (without FCS).
inline constexpr std::size_t kMaxFrame = 1514;        ///< Without FCS.
inline constexpr std::size_t kFrameHeader = 16;       ///< Ethernet header and EtherCAT header.
inline constexpr std::size_t kDatagramHeader = 10;    ///< In front of the data.
inline constexpr std::size_t kDatagramOverhead = 12;  ///< Header and working counter.
inline constexpr std::size_t kMaxDatagramData = kMaxFrame - kFrameHeader - kDatagramOverhead;

/// Position or station address in the low word, register in the high word: as in the header.
constexpr std::uint32_t physical_address(std::uint16_t adp, std::uint16_t ado) {
  return static_cast<std::uint32_t>(ado) << 16U | adp;
}

/// One datagram of a frame, as a view into its bytes.
struct Datagram {
  Command command = Command::nop;  ///< May hold a number above kLastCommand: slaves let it pass.
  std::uint8_t index = 0;          ///< The master's own; slaves do not touch it.
  std::uint32_t address = 0;       ///< physical_address(), or a logical one.
  bool circulating = false;        ///< It has been round once and met an open end.
  std::uint16_t interrupts = 0;    ///< What slaves want to say (0210h), all together.
  ByteSpan data;
  std::uint16_t working_counter = 0;  ///< A read adds 1, a write 1, LRW 1 for its read and 2 for its write.
  std::size_t offset = 0;             ///< Of its first byte in the frame.

  std::uint16_t adp() const { return static_cast<std::uint16_t>(address); }
  std::uint16_t ado() const { return static_cast<std::uint16_t>(address >> 16U); }
};

/// Whether this is an Ethernet frame of EtherCAT at all; everything else on the wire is somebody else's.
bool is_ethercat(ByteSpan frame);

/// The datagrams of a frame (ETG.1000.4, 5.3 and 5.4), checked as a whole before the first is given: no
/// length leads out of the frame.
class FrameReader {
 public:
  /// Errc::protocol for what is no EtherCAT frame of datagrams, or whose lengths do not fit.
  static Result<FrameReader> open(ByteSpan frame);

  std::optional<Datagram> next();  ///< In their order; empty behind the last.

 private:
  explicit FrameReader(ByteSpan frame) : frame_(frame), at_(kFrameHeader) {}
  Result<void> check();

  ByteSpan frame_;
  std::size_t at_;  ///< Of the next datagram; 0 behind the last.
};

/// Puts datagrams into a frame, in a buffer of the caller's.
class FrameWriter {
 public:
  /// `buffer` holds kMinFrame bytes at least; more than kMaxFrame are not used.
  FrameWriter(std::span<std::uint8_t> buffer, const MacAddress& source);

  /// Bytes of data that one more datagram can have; empty when there is no room for one at all.
  std::optional<std::size_t> room() const;
  /// False, and nothing done, when it does not fit. Working counter and interrupts begin with 0.
  bool add(Command command, std::uint8_t index, std::uint32_t address, ByteSpan data);
  bool empty() const { return last_ == 0; }
  /// The frame, padded to kMinFrame; a view into the buffer.
  ByteSpan finish();

 private:
  std::span<std::uint8_t> buffer_;
  std::size_t size_ = kFrameHeader;
  std::size_t last_ = 0;  ///< Where the datagram added last begins; 0: none.
};

/// For the side that answers: the data of a datagram of this frame, to be changed in place.
std::span<std::uint8_t> data_of(std::span<std::uint8_t> frame, const Datagram& datagram);
/// The same, of its other fields.
void set_working_counter(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint16_t value);
void set_address(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint32_t value);
void set_interrupts(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint16_t value);

}  // namespace servoctl::ethercat
