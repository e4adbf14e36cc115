#include "canopen/sdo_block.hpp"

#include <algorithm>
#include <utility>

#include "canopen/sdo_abort.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::size_t kSegmentBytes = 7;
constexpr std::uint8_t kLastSegment = 0x80;
constexpr std::uint8_t kMaxWithoutProgress = 10;

constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t byte = 0; byte < table.size(); ++byte) {
    auto crc = static_cast<std::uint32_t>(byte << 8U);
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U) ^ ((crc & 0x8000U) != 0 ? 0x1021U : 0U);
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

constexpr auto kCrcTable = make_crc_table();

}  // namespace

std::uint16_t sdo_crc(ByteSpan data) {
  std::uint32_t crc = 0;
  for (const auto byte : data) crc = (crc << 8U & 0xFFFFU) ^ kCrcTable[(crc >> 8U) ^ byte];
  return static_cast<std::uint16_t>(crc);
}

void BlockSender::start(Bytes data, std::uint8_t block_size) {
  *this = {};
  data_ = std::move(data);
  block_size_ = block_size;
}

std::optional<SdoSegment> BlockSender::next_segment() {
  if (done_ || is_waiting()) return std::nullopt;
  const auto begin = offset_ + kSegmentBytes * sent_;
  const auto size = std::min(kSegmentBytes, data_.size() - begin);
  last_sent_ = begin + size == data_.size();
  SdoSegment out{};
  out[0] = static_cast<std::uint8_t>(++sent_ | (last_sent_ ? kLastSegment : 0));
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(begin), size, out.begin() + 1);
  return out;
}

std::uint32_t BlockSender::on_acknowledge(std::uint8_t sequence, std::uint8_t block_size) {
  if (sequence > sent_) return sdo_abort::kSequence;
  if (block_size == 0 || block_size > kMaxBlockSize) return sdo_abort::kBlockSize;
  without_progress_ = sequence == 0 ? static_cast<std::uint8_t>(without_progress_ + 1) : std::uint8_t{0};
  if (without_progress_ >= kMaxWithoutProgress) return sdo_abort::kSequence;
  done_ = last_sent_ && sequence == sent_;
  offset_ = std::min(offset_ + kSegmentBytes * sequence, data_.size());
  block_size_ = block_size;
  sent_ = 0;
  last_sent_ = false;
  return 0;
}

std::uint8_t BlockSender::unused_bytes() const {
  const auto rest = data_.size() % kSegmentBytes;
  if (data_.empty()) return kSegmentBytes;
  return static_cast<std::uint8_t>(rest == 0 ? 0 : kSegmentBytes - rest);
}

void BlockReceiver::start(std::uint8_t block_size, const SdoSegment& before) {
  *this = {};
  block_size_ = block_size;
  before_ = before;
}

bool BlockReceiver::on_segment(const SdoSegment& segment) {
  const auto sequence = static_cast<std::uint8_t>(segment[0] & 0x7FU);
  const bool last = (segment[0] & kLastSegment) != 0;
  const bool in_turn = sequence == sequence_ + 1;
  // A frame that comes twice: within a block its number tells, at the border of two blocks only its content.
  if (sequence <= sequence_ || (!in_turn && repeats(segment))) return false;
  before_ = segment;
  if (in_turn) {
    data_.insert(data_.end(), segment.begin() + 1, segment.end());
    sequence_ = sequence;
    has_last_ = last;
  }
  return last || sequence >= block_size_;
}

std::uint8_t BlockReceiver::acknowledge() { return std::exchange(sequence_, std::uint8_t{0}); }

Bytes BlockReceiver::take(std::uint8_t unused) {
  data_.resize(data_.size() - std::min<std::size_t>(unused, data_.size()));
  return std::exchange(data_, {});
}

}  // namespace servoctl::canopen
