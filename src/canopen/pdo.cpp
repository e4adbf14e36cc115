#include "canopen/pdo.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/cob_id.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::uint16_t kMostPdos = 512;

bool bit_at(ByteSpan data, std::size_t bit) {
  return bit / 8 < data.size() && ((static_cast<unsigned>(data[bit / 8]) >> (bit % 8)) & 1U) != 0;
}

void set_bit(Bytes& data, std::size_t bit) {
  data[bit / 8] = static_cast<std::uint8_t>(data[bit / 8] | (1U << (bit % 8)));
}

std::size_t bits_of(std::span<const PdoEntry> entries) {
  std::size_t out = 0;
  for (const auto& entry : entries) out += entry.bits;
  return out;
}

}  // namespace

PdoEntry parse_pdo_entry(std::uint32_t mapping) {
  return {{static_cast<std::uint16_t>(mapping >> 16U), static_cast<std::uint8_t>(mapping >> 8U)},
          static_cast<std::uint8_t>(mapping)};
}

std::uint32_t mapping_of(PdoEntry entry) {
  return static_cast<std::uint32_t>(entry.object.index) << 16U |
         static_cast<std::uint32_t>(entry.object.sub) << 8U | entry.bits;
}

std::uint16_t Pdo::communication_index() const { return index_of({direction, number, false}); }
std::uint16_t Pdo::mapping_index() const { return index_of({direction, number, true}); }
std::size_t Pdo::bits() const { return bits_of(entries); }

std::string name(PdoDirection direction, std::uint16_t number) {
  return formatted("{}PDO{}", direction == PdoDirection::receive ? 'R' : 'T', number);
}

std::optional<Pdo> parse_pdo_name(std::string_view text) {
  const bool receive = starts_with_nocase(text, "RPDO");
  if (!receive && !starts_with_nocase(text, "TPDO")) return std::nullopt;
  const auto number = parse_digits(text.substr(4), 10);
  if (!number || *number == 0 || *number > kMostPdos) return std::nullopt;
  return Pdo{receive ? PdoDirection::receive : PdoDirection::transmit, static_cast<std::uint16_t>(*number)};
}

std::string_view service_of(std::uint32_t can_id) {
  const auto in = [can_id](std::uint32_t first, std::uint32_t last) {
    return can_id >= first && can_id <= last;
  };
  if (can_id == kNmt) return "NMT";
  if (can_id == kSync) return "SYNC";
  if (can_id == 0x100) return "TIME";
  if (in(kEmergency + kFirstNode, kEmergency + kLastNode)) return "EMCY";
  if (in(kSdoAnswer + kFirstNode, kSdoAnswer + kLastNode)) return "SDO";
  if (in(kSdoRequest + kFirstNode, kSdoRequest + kLastNode)) return "SDO";
  if (in(kErrorControl + kFirstNode, kErrorControl + kLastNode)) return "error control";
  if (in(0x001, 0x07F) || in(0x101, 0x180) || in(0x6E0, 0x6FF) || in(0x780, 0x7FF))
    return "a reserved service";
  return {};
}

std::optional<std::vector<Bytes>> unpack_pdo(std::span<const PdoEntry> entries, ByteSpan data) {
  if (bits_of(entries) > data.size() * 8) return std::nullopt;
  std::vector<Bytes> out;
  out.reserve(entries.size());
  std::size_t at = 0;
  for (const auto& entry : entries) {
    Bytes value(entry.is_gap() ? 0 : (entry.bits + 7U) / 8U);
    for (std::size_t bit = 0; bit < entry.bits && !entry.is_gap(); ++bit)
      if (bit_at(data, at + bit)) set_bit(value, bit);
    at += entry.bits;
    out.push_back(std::move(value));
  }
  return out;
}

Bytes pack_pdo(std::span<const PdoEntry> entries, std::span<const Bytes> values) {
  Bytes out((bits_of(entries) + 7) / 8);
  std::size_t at = 0;
  for (std::size_t i = 0; i < entries.size(); at += entries[i].bits, ++i)
    for (std::size_t bit = 0; bit < entries[i].bits && i < values.size(); ++bit)
      if (bit_at(values[i], bit)) set_bit(out, at + bit);
  return out;
}

can::Frame pdo_frame(std::uint32_t can_id, std::span<const std::uint8_t> data) {
  auto frame = can::make_frame(can_id & kPdoCobIdMask, data);
  frame.extended = (can_id & kPdoExtended) != 0;
  return frame;
}

}  // namespace servoctl::canopen
