#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/bytes.hpp"

/// The two ends of a block transfer (CiA 301, 7.2.4.2.9 to 7.2.4.2.16), the same for client and server: up to
/// 127 segments of 7 bytes follow each other, then one acknowledge.
namespace servoctl::canopen {

inline constexpr std::uint8_t kMaxBlockSize = 127;

/// CRC of a block transfer: polynomial 1021h, start value 0 (CiA 301, 7.2.4.3.16).
std::uint16_t sdo_crc(ByteSpan data);

using SdoSegment = std::array<std::uint8_t, 8>;

/// Cuts data into segments, and sends again what was not acknowledged.
class BlockSender {
 public:
  void start(Bytes data, std::uint8_t block_size);

  /// The next segment of this block; none when the other side has to acknowledge first.
  std::optional<SdoSegment> next_segment();
  /// Whether the block is on its way and only the acknowledge is missing.
  bool is_waiting() const { return sent_ == block_size_ || last_sent_; }

  /// The other side got the segments up to `sequence` and wants `block_size` in the next block. What was lost
  /// is sent again. Answers 0 or the abort code: an impossible sequence, an impossible size, or no progress
  /// in ten acknowledges.
  std::uint32_t on_acknowledge(std::uint8_t sequence, std::uint8_t block_size);

  bool is_done() const { return done_; }  ///< Everything was acknowledged.
  /// Bytes of the last segment that carry no data, 0..7.
  std::uint8_t unused_bytes() const;
  std::uint16_t crc() const { return sdo_crc(data_); }
  std::size_t acknowledged() const { return offset_; }
  std::size_t size() const { return data_.size(); }

 private:
  Bytes data_;
  std::size_t offset_ = 0;  ///< Where the block begins.
  std::uint8_t block_size_ = 0;
  std::uint8_t sent_ = 0;
  bool last_sent_ = false;
  bool done_ = false;
  std::uint8_t without_progress_ = 0;
};

/// Puts segments together. Those behind a lost one are dropped: the sender sends them again.
class BlockReceiver {
 public:
  /// `before` is the frame in front of the first segment: seen again, it is no segment.
  void start(std::uint8_t block_size, const SdoSegment& before);

  /// True when the block has ended and acknowledge() is to be sent.
  bool on_segment(const SdoSegment& segment);
  /// The sequence number to acknowledge; the next block begins.
  std::uint8_t acknowledge();

  bool has_last() const { return has_last_; }      ///< The last segment was received in its turn.
  bool has_some() const { return sequence_ > 0; }  ///< Part of this block was received.
  bool repeats(const SdoSegment& segment) const { return segment == before_; }
  std::size_t received() const { return data_.size(); }

  /// The data without the `unused` bytes of the last segment.
  Bytes take(std::uint8_t unused);

 private:
  Bytes data_;
  std::uint8_t block_size_ = 0;
  std::uint8_t sequence_ = 0;  ///< Last one received in its turn.
  bool has_last_ = false;
  SdoSegment before_{};  ///< The frame received last.
};

}  // namespace servoctl::canopen
