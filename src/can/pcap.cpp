#include "can/pcap.hpp"

#include <linux/can.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/format.hpp"
#include "can/byte_cursor.hpp"

namespace servoctl::can {
namespace {

constexpr std::uint32_t kMicros = 0xA1B2C3D4;
constexpr std::uint32_t kNanos = 0xA1B23C4D;
constexpr std::uint32_t kSection = 0x0A0D0D0A;
constexpr std::uint32_t kByteOrder = 0x1A2B3C4D;
constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kPacketHeader = 16;

constexpr std::uint32_t kEthernet = 1;
constexpr std::uint32_t kCan = 227;
constexpr std::uint32_t kCooked = 113;
constexpr std::uint32_t kCooked2 = 276;
constexpr std::uint16_t kEtherCan = 0x000C;  ///< ETH_P_CAN
constexpr std::uint8_t kFdFrame = 0x04;      ///< CANFD_FDF

/// No capture lies so far from 1970.
constexpr std::uint64_t kLastSecond = 100'000'000'000;

Duration since_epoch(std::uint64_t seconds, std::uint64_t micros) {
  return Duration(static_cast<std::int64_t>(std::min(seconds, kLastSecond) * 1'000'000 + micros));
}

/// Where a capture came from.
struct Source {
  std::uint32_t link = 0;
  std::string name;
  std::uint8_t resolution = 6;  ///< As if_tsresol: a power of ten, or of two where the high bit is set.
};

Duration time_of_packet(std::uint64_t stamp, std::uint8_t resolution) {
  const unsigned power = resolution & 0x7FU;
  if ((resolution & 0x80U) != 0) {
    if (power > 63) return {};
    const auto seconds = stamp >> power;
    auto fraction = stamp & ((std::uint64_t{1} << power) - 1);
    const unsigned bits = std::min(power, 32U);
    fraction >>= power - bits;
    return since_epoch(seconds, fraction * 1'000'000 >> bits);
  }
  if (power > 19) return {};
  std::uint64_t scale = 1;
  for (unsigned i = 0; i < power; ++i) scale *= 10;
  const auto fraction = stamp % scale;
  return since_epoch(stamp / scale,
                     scale > 1'000'000 ? fraction / (scale / 1'000'000) : fraction * (1'000'000 / scale));
}

enum class Packet : std::uint8_t { frame, unsuited, malformed, ethercat };

/// Whether an Ethernet frame carries EtherCAT, behind tags of VLANs or not.
bool is_ethercat(std::string_view bytes) {
  constexpr std::size_t kAddresses = 12;
  constexpr std::uint16_t kVlan = 0x8100;
  constexpr std::uint16_t kEtherCat = 0x88A4;
  if (bytes.size() < kAddresses) return false;
  ByteCursor in(bytes.substr(kAddresses), true);
  auto type = in.u16();
  while (type == kVlan && in.ok()) {
    in.skip(2);
    type = in.u16();
  }
  return in.ok() && type == kEtherCat;
}

/// The CAN frame of a packet: identifier with flags, length, flags of CAN FD, two unused bytes, data. `big`:
/// the order of the identifier's bytes.
Packet parse_can(std::string_view bytes, bool big, Frame& out) {
  ByteCursor in(bytes, big);
  const auto id = in.u32();
  const auto size = in.u8();
  const auto flags = in.u8();
  in.skip(2);
  if (!in.ok()) return Packet::malformed;
  if (size > CAN_MAX_DLEN || (flags & kFdFrame) != 0) return Packet::unsuited;
  out.error = (id & CAN_ERR_FLAG) != 0;
  out.extended = !out.error && (id & CAN_EFF_FLAG) != 0;
  out.remote = !out.error && (id & CAN_RTR_FLAG) != 0;
  out.id = id & (out.error || out.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  out.size = size;
  if (!out.remote && in.rest().size() < size) return Packet::malformed;
  for (std::size_t i = 0; i < out.payload().size(); ++i) out.data[i] = in.u8();
  return Packet::frame;
}

/// The identifier is big-endian where the link is CAN, and as the file's own numbers (`big`) in a cooked
/// capture (libpcap swaps it with them).
Packet parse_packet(std::uint32_t link, bool big, std::string_view bytes, Frame& out) {
  if (link == kCan) return parse_can(bytes, true, out);
  if (link == kEthernet && is_ethercat(bytes)) return Packet::ethercat;
  if (link != kCooked && link != kCooked2) return Packet::unsuited;
  const std::size_t header = link == kCooked ? 16 : 20;
  if (bytes.size() < header) return Packet::malformed;
  ByteCursor protocol(bytes.substr(link == kCooked ? 14 : 0), true);
  if (protocol.u16() != kEtherCan) return Packet::unsuited;
  return parse_can(bytes.substr(header), big, out);
}

/// Both forms: counts, and hands on.
class PcapReader {
 public:
  PcapReader(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options)
      : bytes_(&bytes), take_(&take) {
    out_.records = true;
    if (options.clock != nullptr) *options.clock = {LogClock::Kind::utc, {}};
  }

  RecordingStrays read() {
    if (ByteCursor(bytes_->ahead(4)).u32() == kSection)
      read_blocks();
    else
      read_packets();
    return std::move(out_);
  }

 private:
  void damaged(std::size_t offset, std::string what) {
    out_.damage = RecordingDamage{offset, std::move(what)};
  }

  /// False: no more.
  bool take(const Source& source, std::string_view bytes, Duration time) {
    ++number_;
    Frame frame;
    const auto packet = parse_packet(source.link, big_, bytes, frame);
    if (packet == Packet::malformed) out_.add_unknown(number_);
    out_.unsuited += packet == Packet::unsuited || packet == Packet::ethercat;
    out_.ethercat += packet == Packet::ethercat;
    return packet != Packet::frame || (*take_)({time, source.name, frame});
  }

  void read_packets() {
    const auto begin = bytes_->ahead(kFileHeader);
    const auto magic = ByteCursor(begin, true).u32();
    big_ = magic == kMicros || magic == kNanos;
    const bool nanos = magic == kNanos || ByteCursor(begin).u32() == kNanos;
    if (begin.size() < kFileHeader) return damaged(begin.size(), "its header is cut short");
    ByteCursor header(begin.substr(20), big_);
    const Source source{header.u32() & 0xFFFFU, "can0", 6};
    bytes_->drop(kFileHeader);
    while (!bytes_->at_end()) {
      const auto head = bytes_->ahead(kPacketHeader);
      if (head.size() < kPacketHeader) return damaged(bytes_->offset(), "it ends in the middle of a packet");
      ByteCursor in(head, big_);
      const auto seconds = in.u32();
      const auto fraction = in.u32();
      const std::size_t size = in.u32();
      const auto packet = bytes_->ahead(kPacketHeader + size).substr(kPacketHeader);
      if (size > packet.size())
        return damaged(bytes_->offset(),
                       formatted("a packet of {} bytes begins there, and {} are left", size, packet.size()));
      if (!take(source, packet.substr(0, size), since_epoch(seconds, nanos ? fraction / 1000 : fraction)))
        return;
      bytes_->drop(kPacketHeader + size);
    }
  }

  void read_blocks() {
    while (!bytes_->at_end()) {
      const auto at = bytes_->offset();
      const auto head = bytes_->ahead(12);
      if (head.size() < 12) return damaged(at, "it ends in the middle of a block");
      if (ByteCursor(head).u32() == kSection) {
        sources_.clear();
        big_ = ByteCursor(head.substr(8), true).u32() == kByteOrder;
        if (!big_ && ByteCursor(head.substr(8)).u32() != kByteOrder)
          return damaged(at, "a section begins there without a byte order");
      }
      ByteCursor in(head, big_);
      const auto type = in.u32();
      const std::size_t size = in.u32();
      if (size < 12 || size % 4 != 0) return damaged(at, formatted("a block of {} bytes begins there", size));
      const auto block = bytes_->ahead(size);
      if (size > block.size())
        return damaged(at,
                       formatted("a block of {} bytes begins there, and {} are left", size, block.size()));
      if (!read_block(type, block.substr(8, size - 12))) return;
      bytes_->drop(size);
    }
  }

  bool read_block(std::uint32_t type, std::string_view body) {
    constexpr std::uint32_t kInterface = 1;
    constexpr std::uint32_t kSimplePacket = 3;
    constexpr std::uint32_t kEnhancedPacket = 6;
    if (type == kInterface) add_interface(body);
    if (type == kSimplePacket) {
      ByteCursor in(body, big_);
      const auto size = std::min<std::size_t>(in.u32(), in.rest().size());
      return packet_of(0, in.rest().substr(0, size), 0);
    }
    if (type != kEnhancedPacket) return true;
    ByteCursor in(body, big_);
    const auto source = in.u32();
    const std::uint64_t high = in.u32();
    const std::uint64_t stamp = high << 32U | in.u32();
    const std::size_t size = in.u32();
    in.skip(4);
    if (in.ok() && size <= in.rest().size()) return packet_of(source, in.rest().substr(0, size), stamp);
    out_.add_unknown(++number_);
    return true;
  }

  bool packet_of(std::size_t source, std::string_view bytes, std::uint64_t stamp) {
    if (source < sources_.size())
      return take(sources_[source], bytes, time_of_packet(stamp, sources_[source].resolution));
    out_.add_unknown(++number_);
    return true;
  }

  void add_interface(std::string_view body) {
    constexpr std::uint16_t kName = 2;
    constexpr std::uint16_t kResolution = 9;
    ByteCursor in(body, big_);
    Source source{in.u16(), formatted("can{}", sources_.size()), 6};
    in.skip(6);
    while (in.ok() && in.rest().size() >= 4) {
      const auto code = in.u16();
      const std::size_t size = in.u16();
      if (code == 0 || size > in.rest().size()) break;
      const auto value = in.rest().substr(0, size);
      if (code == kName && !value.empty() && value.find_first_of(" \t\r\n") == std::string_view::npos)
        source.name = value;
      if (code == kResolution && size == 1) source.resolution = static_cast<std::uint8_t>(value.front());
      in.skip(std::min((size + 3) / 4 * 4, in.rest().size()));
    }
    sources_.push_back(std::move(source));
  }

  ByteWindow* bytes_;
  const TakeLogFrame* take_;
  bool big_ = false;
  std::vector<Source> sources_;
  std::size_t number_ = 0;
  RecordingStrays out_;
};

}  // namespace

bool is_pcap(std::string_view beginning) {
  if (beginning.size() < 4) return false;
  const auto little = ByteCursor(beginning).u32();
  const auto big = ByteCursor(beginning, true).u32();
  return little == kMicros || little == kNanos || big == kMicros || big == kNanos || little == kSection;
}

RecordingStrays read_pcap(ByteWindow& bytes, const TakeLogFrame& take, const ReadOptions& options) {
  return PcapReader(bytes, take, options).read();
}

}  // namespace servoctl::can
