#include "traffic/lss_words.hpp"

#include "base/bytes.hpp"
#include "base/format.hpp"
#include "canopen/lss.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::traffic {
namespace {

using canopen::LssService;

constexpr std::string_view kLssParts[] = {"vendor", "product", "revision", "serial"};
constexpr std::string_view kLssRanges[] = {
    "vendor is",           "product is",         "revision is at least",
    "revision is at most", "serial is at least", "serial is at most"};

std::string node_words(std::uint32_t node) {
  return node == canopen::kUnconfigured ? std::string("none (255)") : formatted("{}", node);
}

int place_in(LssService service, LssService first) {
  return static_cast<int>(service) - static_cast<int>(first);
}

std::string bit_timing_words(const can::Frame& frame) {
  if (frame.data[1] != 0) return formatted("LSS set bit timing {} of table {}", frame.data[2], frame.data[1]);
  if (frame.data[2] == canopen::kLssAutomaticBitrate) return "LSS set bitrate: automatic detection";
  const auto bitrate = canopen::lss_bitrate(frame.data[2]);
  return bitrate ? "LSS set bitrate " + drive::bitrate_text(*bitrate)
                 : formatted("LSS set bitrate: {} is reserved", frame.data[2]);
}

std::string fastscan_words(const can::Frame& frame, std::uint32_t number) {
  const unsigned bit = frame.data[5], part = frame.data[6], next = frame.data[7];
  if (bit == canopen::kFastscanBegin) return "LSS fastscan: who has no node-ID?";
  if (bit > 31 || part > 3 || next > 3) return "LSS fastscan, with a part that CiA 305 does not define";
  if (bit == 0 && next != part)
    return formatted("LSS fastscan: {} is 0x{:08X}? {}", kLssParts[part], number,
                     next < part ? "Then it is selected" : formatted("Then {}", kLssParts[next]));
  return formatted("LSS fastscan: {} from bit {} on as in 0x{:08X}?", kLssParts[part], bit, number);
}

std::string request_words(const can::Frame& frame) {
  const auto service = static_cast<LssService>(frame.data[0]);
  const auto number = static_cast<std::uint32_t>(load_le(std::span(frame.data).subspan(1, 4)));
  switch (service) {
    case LssService::switch_all:
      if (frame.data[1] > 1) break;
      return frame.data[1] == 0 ? "LSS all to waiting" : "LSS all to configuration";
    case LssService::set_node: return "LSS set node-ID " + node_words(frame.data[1]);
    case LssService::set_bit_timing: return bit_timing_words(frame);
    case LssService::activate_bit_timing:
      return formatted("LSS activate bitrate after {} ms", number & 0xFFFFU);
    case LssService::store: return "LSS store configuration";
    case LssService::identify_unconfigured: return "LSS who has no node-ID?";
    case LssService::fastscan: return fastscan_words(frame, number);
    case LssService::inquire_node: return "LSS inquire node-ID";
    default: break;
  }
  if (const auto i = place_in(service, LssService::select_vendor); i >= 0 && i < 4)
    return formatted("LSS select: {} is 0x{:08X}", kLssParts[i], number);
  if (const auto i = place_in(service, LssService::identify_vendor); i >= 0 && i < 6)
    return formatted("LSS who is it whose {} 0x{:08X}?", kLssRanges[i], number);
  if (const auto i = place_in(service, LssService::inquire_vendor); i >= 0 && i < 4)
    return formatted("LSS inquire {}", kLssParts[i]);
  return formatted("LSS request 0x{:02X}, which CiA 305 does not define", frame.data[0]);
}

std::string answer_words(const canopen::LssAnswer& answer) {
  const auto done = [&](std::string_view what) {
    return answer.error == 0 ? formatted("LSS slave: {}", what)
                             : "LSS slave: refused, " + canopen::lss_error_text(answer);
  };
  switch (answer.service) {
    case LssService::set_node: return done("node-ID set");
    case LssService::set_bit_timing: return done("bitrate set");
    case LssService::store: return done("configuration stored");
    case LssService::selected: return "LSS slave: selected";
    case LssService::identified: return "LSS slave: it fits";
    case LssService::unconfigured: return "LSS slave: has no node-ID";
    case LssService::inquire_node: return "LSS slave: node-ID " + node_words(answer.number & 0xFFU);
    default: break;
  }
  if (const auto i = place_in(answer.service, LssService::inquire_vendor); i >= 0 && i < 4)
    return formatted("LSS slave: {} 0x{:08X}", kLssParts[i], answer.number);
  return formatted("LSS answer 0x{:02X}, which CiA 305 does not define",
                   static_cast<unsigned>(answer.service));
}

}  // namespace

std::string lss_text(const can::Frame& frame) {
  if (frame.remote || frame.size != 8) return "no LSS of CiA 305";
  const auto answer = canopen::parse_lss_answer(frame);
  return answer ? answer_words(*answer) : request_words(frame);
}

}  // namespace servoctl::traffic
