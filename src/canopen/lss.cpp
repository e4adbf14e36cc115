#include "canopen/lss.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "base/bytes.hpp"
#include "base/format.hpp"

namespace servoctl::canopen {
namespace {

/// Table 0; 0 is reserved or automatic.
constexpr std::uint32_t kLssBitrates[] = {1'000'000, 800'000, 500'000, 250'000, 125'000,
                                          0,         50'000,  20'000,  10'000};

/// What stands behind the service is zero where nothing is said.
can::Frame lss_frame(LssService service, std::uint64_t value = 0, std::size_t size = 0) {
  std::array<std::uint8_t, 8> data{};
  data[0] = static_cast<std::uint8_t>(service);
  store_le(value, std::span(data).subspan(1, size));
  return can::make_frame(kLssRequest, data);
}

LssService following(LssService first, int steps) {
  return static_cast<LssService>(static_cast<int>(first) + steps);
}

}  // namespace

std::string to_string(const LssAddress& address) {
  return formatted("vendor 0x{:08X}, product 0x{:08X}, revision 0x{:08X}, serial {}", address.vendor,
                   address.product, address.revision, address.serial);
}

LssRequest lss_switch_all(LssState state) {
  return {{lss_frame(LssService::switch_all, static_cast<std::uint8_t>(state), 1)}, std::nullopt};
}

LssRequest lss_select(const LssAddress& address) {
  LssRequest out{{}, LssService::selected};
  const std::uint32_t parts[] = {address.vendor, address.product, address.revision, address.serial};
  for (int i = 0; i < 4; ++i)
    out.frames.push_back(lss_frame(following(LssService::select_vendor, i), parts[i], 4));
  return out;
}

LssRequest lss_set_node(std::uint8_t node) {
  return {{lss_frame(LssService::set_node, node, 1)}, LssService::set_node};
}

LssRequest lss_set_bit_timing(std::uint8_t index) {
  const std::uint64_t table_and_index = std::uint64_t{index} << 8U;
  return {{lss_frame(LssService::set_bit_timing, table_and_index, 2)}, LssService::set_bit_timing};
}

LssRequest lss_activate_bit_timing(std::uint16_t delay_ms) {
  return {{lss_frame(LssService::activate_bit_timing, delay_ms, 2)}, std::nullopt};
}

LssRequest lss_store() { return {{lss_frame(LssService::store)}, LssService::store}; }

LssRequest lss_inquire(LssService what) { return {{lss_frame(what)}, what}; }

LssRequest lss_identify(const LssAddress& low, const LssAddress& high) {
  LssRequest out{{}, LssService::identified};
  const std::uint32_t parts[] = {low.vendor,    low.product, low.revision,
                                 high.revision, low.serial,  high.serial};
  for (int i = 0; i < 6; ++i)
    out.frames.push_back(lss_frame(following(LssService::identify_vendor, i), parts[i], 4));
  return out;
}

LssRequest lss_identify_unconfigured() {
  return {{lss_frame(LssService::identify_unconfigured)}, LssService::unconfigured};
}

LssRequest lss_fastscan(const LssFastscanStep& step) {
  auto frame = lss_frame(LssService::fastscan, step.number, 4);
  frame.data[5] = step.bit;
  frame.data[6] = step.part;
  frame.data[7] = step.next;
  return {{frame}, LssService::identified};
}

std::optional<std::uint8_t> lss_bit_timing(std::uint32_t bitrate) {
  const auto* const found = std::find(std::begin(kLssBitrates), std::end(kLssBitrates), bitrate);
  if (bitrate == 0 || found == std::end(kLssBitrates)) return std::nullopt;
  return static_cast<std::uint8_t>(found - std::begin(kLssBitrates));
}

std::optional<std::uint32_t> lss_bitrate(std::uint8_t index) {
  if (index >= std::size(kLssBitrates) || kLssBitrates[index] == 0) return std::nullopt;
  return kLssBitrates[index];
}

std::optional<LssAnswer> parse_lss_answer(const can::Frame& frame) {
  if (frame.id != kLssAnswer || frame.extended || frame.error || frame.remote || frame.size != 8)
    return std::nullopt;
  return LssAnswer{static_cast<LssService>(frame.data[0]), frame.data[1], frame.data[2],
                   static_cast<std::uint32_t>(load_le(std::span(frame.data).subspan(1, 4)))};
}

std::string lss_error_text(const LssAnswer& answer) {
  if (answer.error == 0xFF) return formatted("an error of its maker's own, {}", answer.specific);
  if (answer.service == LssService::set_node && answer.error == 1) return "the node-ID is out of its range";
  if (answer.service == LssService::set_bit_timing && answer.error == 1)
    return "it does not support this bitrate";
  if (answer.service == LssService::store && answer.error == 1) return "it cannot store its configuration";
  if (answer.service == LssService::store && answer.error == 2) return "it could not write to its memory";
  return formatted("error {}, which CiA 305 does not define", answer.error);
}

}  // namespace servoctl::canopen
