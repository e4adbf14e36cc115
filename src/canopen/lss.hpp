#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "can/frame.hpp"
#include "canopen/node_id.hpp"

/// The services of LSS (CiA 305, layer setting services): frames of 8 bytes that give a device its node-ID
/// and its bitrate without knowing either; the device is told apart by its identity object (1018h).
namespace servoctl::canopen {

/// The identifiers of LSS (CiA 305, 5.2).
inline constexpr std::uint32_t kLssRequest = 0x7E5;  ///< From the master.
inline constexpr std::uint32_t kLssAnswer = 0x7E4;   ///< From a slave.

/// The first byte of a frame.
enum class LssService : std::uint8_t {
  switch_all = 0x04,
  set_node = 0x11,
  set_bit_timing = 0x13,
  activate_bit_timing = 0x15,
  store = 0x17,
  select_vendor = 0x40,
  select_product = 0x41,
  select_revision = 0x42,
  select_serial = 0x43,
  selected = 0x44,
  identify_vendor = 0x46,
  identify_product = 0x47,
  identify_revision_low = 0x48,
  identify_revision_high = 0x49,
  identify_serial_low = 0x4A,
  identify_serial_high = 0x4B,
  identify_unconfigured = 0x4C,
  identified = 0x4F,
  unconfigured = 0x50,
  fastscan = 0x51,
  inquire_vendor = 0x5A,
  inquire_product = 0x5B,
  inquire_revision = 0x5C,
  inquire_serial = 0x5D,
  inquire_node = 0x5E,
};

/// In the waiting state a slave does nothing but listen for who is meant; in the configuration state it takes
/// what is set.
enum class LssState : std::uint8_t { waiting = 0, configuration = 1 };

/// 1018h:01 to 1018h:04, which tell a slave apart.
struct LssAddress {
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial = 0;

  bool operator==(const LssAddress&) const = default;
};

/// `vendor 0x00445653, product 0x00000001, revision 0x00000001, serial 2`.
std::string to_string(const LssAddress& address);

/// One question to the slaves: all its frames, and the service of the answer; none where slaves answer
/// nothing.
struct LssRequest {
  std::vector<can::Frame> frames;
  std::optional<LssService> answer;
};

/// Every slave goes to the state; none answers (CiA 305, switch state global).
LssRequest lss_switch_all(LssState state);
/// The one slave of this identity goes to the configuration state, and says so (switch state selective).
LssRequest lss_select(const LssAddress& address);
/// `node` 1..127 or kUnconfigured.
LssRequest lss_set_node(std::uint8_t node);
/// `index` is one of table 0: see lss_bit_timing().
LssRequest lss_set_bit_timing(std::uint8_t index);
/// Slaves are silent for `delay_ms`, change, and are silent for as long again; none answers.
LssRequest lss_activate_bit_timing(std::uint16_t delay_ms);
LssRequest lss_store();
/// `what` is one of the inquire_… services.
LssRequest lss_inquire(LssService what);
/// Whoever lies between the two answers; vendor and product are those of `low`.
LssRequest lss_identify(const LssAddress& low, const LssAddress& high);
/// Whoever has no node-ID answers.
LssRequest lss_identify_unconfigured();

/// What a step of fastscan asks: whoever has no node-ID, is asked for part `part` (0..3: vendor, product,
/// revision, serial) and has the bits of `number` from `bit` (0..31) on upwards. All that answer are asked
/// for `next` from then on; with bit 0 and a `next` below `part` the one that answers goes to the
/// configuration state.
struct LssFastscanStep {
  std::uint32_t number = 0;
  std::uint8_t bit = 0;
  std::uint8_t part = 0;
  std::uint8_t next = 0;
};
/// In place of a bit: all that have no node-ID answer, and begin anew.
inline constexpr std::uint8_t kFastscanBegin = 0x80;
LssRequest lss_fastscan(const LssFastscanStep& step);

/// The index of a bitrate in table 0 (CiA 305, standardised bit timing parameters), in bit/s; empty where it
/// has none.
std::optional<std::uint8_t> lss_bit_timing(std::uint32_t bitrate);
/// The other way round; empty for those that are reserved and for 9, automatic detection.
std::optional<std::uint32_t> lss_bitrate(std::uint8_t index);
inline constexpr std::uint8_t kLssAutomaticBitrate = 9;

/// What a slave answered.
struct LssAnswer {
  LssService service{};
  std::uint8_t error = 0;     ///< Byte 1 of configure and store: 0 is done.
  std::uint8_t specific = 0;  ///< Byte 2 of these: the maker's own, where the error is 255.
  std::uint32_t number = 0;   ///< What was inquired, from byte 1 on.

  bool operator==(const LssAnswer&) const = default;
};

/// Empty for what is no answer of a slave.
std::optional<LssAnswer> parse_lss_answer(const can::Frame& frame);
/// Why the slave refuses, such as `the node-ID is out of its range`; of set_node, set_bit_timing and store.
std::string lss_error_text(const LssAnswer& answer);

}  // namespace servoctl::canopen
