#include "ethercat/frame.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::size_t kTypeAt = 12;
constexpr std::size_t kLengthAt = 14;
constexpr std::uint16_t kLengthMask = 0x07FF;
constexpr std::uint16_t kCirculating = 0x4000;
constexpr std::uint16_t kMoreFollow = 0x8000;
/// Type 1 of the EtherCAT header: datagrams. 4 are network variables, 5 a mailbox gateway.
constexpr std::uint16_t kDatagrams = 1;

constexpr auto kNames =
    std::to_array<std::string_view>({"NOP", "APRD", "APWR", "APRW", "FPRD", "FPWR", "FPRW", "BRD", "BWR",
                                     "BRW", "LRD", "LWR", "LRW", "ARMW", "FRMW"});

void put_word(std::span<std::uint8_t> bytes, std::size_t at, std::uint16_t value) {
  store_le(value, bytes.subspan(at, 2));
}

std::size_t data_size(ByteSpan frame, std::size_t datagram) {
  return word_at(frame, datagram + 6) & kLengthMask;
}

tl::unexpected<Error> malformed(Message what) {
  return fail(Errc::protocol, "damaged EtherCAT frame: " + std::move(what),
              "frames are truncated or altered on the way: check the interface and the cable");
}

}  // namespace

std::string_view name(Command command) {
  const auto number = static_cast<std::size_t>(command);
  return number < kNames.size() ? kNames[number] : "unknown command";
}

bool reads(Command command) {
  switch (command) {
    case Command::aprd:
    case Command::aprw:
    case Command::fprd:
    case Command::fprw:
    case Command::brd:
    case Command::brw:
    case Command::lrd:
    case Command::lrw:
    case Command::armw:
    case Command::frmw: return true;
    default: return false;
  }
}

bool writes(Command command) {
  switch (command) {
    case Command::apwr:
    case Command::aprw:
    case Command::fpwr:
    case Command::fprw:
    case Command::bwr:
    case Command::brw:
    case Command::lwr:
    case Command::lrw:
    case Command::armw:
    case Command::frmw: return true;
    default: return false;
  }
}

bool is_ethercat(ByteSpan frame) {
  return frame.size() >= kLengthAt && frame[kTypeAt] == kEtherType >> 8U &&
         frame[kTypeAt + 1] == (kEtherType & 0xFFU);
}

Result<FrameReader> FrameReader::open(ByteSpan frame) {
  if (!is_ethercat(frame)) return fail(Errc::protocol, "not an EtherCAT frame");
  FrameReader reader(frame);
  if (auto checked = reader.check(); !checked) return fail(checked.error());
  return reader;
}

Result<void> FrameReader::check() {
  if (frame_.size() < kFrameHeader) return malformed("it ends before its header");
  const auto header = word_at(frame_, kLengthAt);
  const std::size_t length = header & kLengthMask;
  if (header >> 12U != kDatagrams) return malformed(message("it is of type {}, not 1", header >> 12U));
  if (kFrameHeader + length > frame_.size())
    return malformed(message("it announces {} bytes and has {}", length, frame_.size() - kFrameHeader));
  frame_ = frame_.first(kFrameHeader + length);
  for (std::size_t at = kFrameHeader;;) {
    if (at + kDatagramOverhead > frame_.size()) return malformed("a datagram begins beyond its end");
    const auto end = at + kDatagramOverhead + data_size(frame_, at);
    if (end > frame_.size())
      return malformed(message("a datagram of {} bytes extends beyond its end", data_size(frame_, at)));
    if ((word_at(frame_, at + 6) & kMoreFollow) == 0) return {};
    at = end;
  }
}

std::optional<Datagram> FrameReader::next() {
  if (at_ == 0) return std::nullopt;
  Datagram out;
  out.offset = at_;
  out.command = static_cast<Command>(frame_[at_]);
  out.index = frame_[at_ + 1];
  out.address = dword_at(frame_, at_ + 2);
  const auto length = word_at(frame_, at_ + 6);
  out.circulating = (length & kCirculating) != 0;
  out.interrupts = word_at(frame_, at_ + 8);
  out.data = frame_.subspan(at_ + kDatagramHeader, length & kLengthMask);
  out.working_counter = word_at(frame_, at_ + kDatagramHeader + out.data.size());
  at_ = (length & kMoreFollow) != 0 ? at_ + kDatagramOverhead + out.data.size() : 0;
  return out;
}

FrameWriter::FrameWriter(std::span<std::uint8_t> buffer, const MacAddress& source)
    : buffer_(buffer.first(std::min(buffer.size(), kMaxFrame))) {
  std::fill_n(buffer_.begin(), 6, std::uint8_t{0xFF});
  std::copy(source.begin(), source.end(), buffer_.begin() + 6);
  buffer_[kTypeAt] = kEtherType >> 8U;
  buffer_[kTypeAt + 1] = kEtherType & 0xFFU;
}

std::optional<std::size_t> FrameWriter::room() const {
  if (size_ + kDatagramOverhead > buffer_.size()) return std::nullopt;
  return buffer_.size() - size_ - kDatagramOverhead;
}

bool FrameWriter::add(Command command, std::uint8_t index, std::uint32_t address, ByteSpan data) {
  const auto free = room();
  if (!free || data.size() > *free) return false;
  if (last_ != 0)
    put_word(buffer_, last_ + 6, static_cast<std::uint16_t>(word_at(buffer_, last_ + 6) | kMoreFollow));
  last_ = size_;
  buffer_[size_] = static_cast<std::uint8_t>(command);
  buffer_[size_ + 1] = index;
  store_le(address, buffer_.subspan(size_ + 2, 4));
  put_word(buffer_, size_ + 6, static_cast<std::uint16_t>(data.size()));
  put_word(buffer_, size_ + 8, 0);
  std::copy(data.begin(), data.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(size_ + kDatagramHeader));
  size_ += kDatagramHeader + data.size();
  put_word(buffer_, size_, 0);
  size_ += 2;
  return true;
}

ByteSpan FrameWriter::finish() {
  put_word(buffer_, kLengthAt, static_cast<std::uint16_t>((size_ - kFrameHeader) | kDatagrams << 12U));
  const auto padded = std::max(size_, kMinFrame);
  std::fill(buffer_.begin() + static_cast<std::ptrdiff_t>(size_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(padded), std::uint8_t{0});
  return buffer_.first(padded);
}

std::span<std::uint8_t> data_of(std::span<std::uint8_t> frame, const Datagram& datagram) {
  return frame.subspan(datagram.offset + kDatagramHeader, datagram.data.size());
}

void set_working_counter(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint16_t value) {
  put_word(frame, datagram.offset + kDatagramHeader + datagram.data.size(), value);
}

void set_address(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint32_t value) {
  store_le(value, frame.subspan(datagram.offset + 2, 4));
}

void set_interrupts(std::span<std::uint8_t> frame, const Datagram& datagram, std::uint16_t value) {
  put_word(frame, datagram.offset + 8, value);
}

}  // namespace servoctl::ethercat
