#include "ethernet/pcap_format.hpp"

#include <cstddef>

namespace servoctl::ethernet {
namespace {

constexpr std::uint32_t kSnapLength = 65535;
constexpr std::uint16_t kEthernet = 1;

// Types of blocks and options of the newer form.
constexpr std::uint32_t kSection = 0x0A0D0D0A;
constexpr std::uint32_t kInterface = 1;
constexpr std::uint32_t kPacket = 6;
constexpr std::uint16_t kInterfaceName = 2;
constexpr std::uint16_t kPacketFlags = 2;

/// Little endian, as the magic numbers say.
void put(std::string& out, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * i) & 0xFFU);
}

void pad_to_four(std::string& out) {
  while (out.size() % 4 != 0) out += '\0';
}

void put_option(std::string& out, std::uint16_t type, std::string_view value) {
  put(out, type, 2);
  put(out, value.size(), 2);
  out += value;
  pad_to_four(out);
}

void put_bytes(std::string& out, ByteSpan bytes) {
  for (const auto byte : bytes) out += static_cast<char>(byte);
}

/// Its length stands in front of the body and behind it, so that a file can be read backwards.
std::string block(std::uint32_t type, std::string_view body) {
  const auto size = body.size() + 12;
  std::string out;
  put(out, type, 4);
  put(out, size, 4);
  out += body;
  put(out, size, 4);
  return out;
}

std::string classic_head() {
  std::string out;
  put(out, 0xA1B2C3D4, 4);
  put(out, 2, 2);  // Version 2.4.
  put(out, 4, 2);
  put(out, 0, 8);
  put(out, kSnapLength, 4);
  put(out, kEthernet, 4);
  return out;
}

std::string next_head(std::string_view interface_name) {
  std::string section;
  put(section, 0x1A2B3C4D, 4);
  put(section, 1, 2);  // Version 1.0.
  put(section, 0, 2);
  put(section, ~std::uint64_t{0}, 8);  // How long the section is, is not known.
  std::string interface;
  put(interface, kEthernet, 2);
  put(interface, 0, 2);
  put(interface, kSnapLength, 4);
  put_option(interface, kInterfaceName, interface_name);
  put_option(interface, 0, {});
  return block(kSection, section) + block(kInterface, interface);
}

}  // namespace

std::string pcap_head(PcapForm form, std::string_view interface_name) {
  return form == PcapForm::classic ? classic_head() : next_head(interface_name);
}

std::string pcap_record(PcapForm form, Duration time, Direction direction, ByteSpan frame) {
  const auto micros = static_cast<std::uint64_t>(time.count());
  std::string out;
  if (form == PcapForm::classic) {
    put(out, micros / 1'000'000, 4);
    put(out, micros % 1'000'000, 4);
    put(out, frame.size(), 4);
    put(out, frame.size(), 4);
    put_bytes(out, frame);
    return out;
  }
  put(out, 0, 4);  // The first interface.
  put(out, micros >> 32U, 4);
  put(out, micros, 4);
  put(out, frame.size(), 4);
  put(out, frame.size(), 4);
  put_bytes(out, frame);
  pad_to_four(out);
  std::string flags;
  put(flags, static_cast<std::uint64_t>(direction), 4);
  put_option(out, kPacketFlags, flags);
  put_option(out, 0, {});
  return block(kPacket, out);
}

}  // namespace servoctl::ethernet
