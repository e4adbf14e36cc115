#include "ethercat/al_status.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "ethercat/registers.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

struct Row {
  std::uint16_t code;
  std::string_view text;
  std::string_view hint;
};

constexpr std::string_view kMailbox =
    "sync managers 0 and 1 do not match what the slave expects: does its SII list its mailboxes? `scan` shows it";
constexpr std::string_view kLengths =
    "the sync manager length does not match the assigned PDOs: `pdo show` shows 1C12h, 1C13h and the mappings";
constexpr std::string_view kMapping =
    "1C12h, 1C13h or a mapping names something the drive does not accept: `pdo show` shows them, `pdo preset` corrects them";
constexpr std::string_view kDc =
    "the drive needs distributed clocks (SYNC0), or does not accept this cycle: check its synchronisation (1C32h, 1C33h) in its manual";
constexpr std::string_view kCycle =
    "the drive does not accept this cycle with distributed clocks: its manual lists the cycles";
constexpr std::string_view kFrames =
    "process data did not reach the drive in time: check for lost frames, a loaded computer and the cables";
constexpr std::string_view kPower = "power cycle the drive";

constexpr std::array kRows{
    Row{0x0000, "no error", ""},
    Row{0x0001, "unspecified error", "check the drive's own fault with `fault show`"},
    Row{0x0002, "out of memory", kPower},
    Row{0x0003, "invalid device setup", "the modules or options of the drive do not match its settings"},
    Row{0x0004, "invalid revision", "its firmware does not match its hardware"},
    Row{0x0006, "its SII does not match its firmware", "rewrite the SII from the vendor's file"},
    Row{0x0007, "firmware update failed", "load the firmware again"},
    Row{0x000E, "licence error", ""},
    Row{0x0011, "invalid state change requested",
        "states are entered one at a time: INIT, PRE-OP, SAFE-OP, OP; the slave may have fallen back in the meantime"},
    Row{0x0012, "unknown state requested", ""},
    Row{0x0013, "bootstrap state not supported", "its firmware is updated another way"},
    Row{0x0014, "no valid firmware", "load the firmware again"},
    Row{0x0015, "invalid mailbox settings for the bootstrap state", kMailbox},
    Row{0x0016, "invalid mailbox settings for PRE-OP", kMailbox},
    Row{0x0017, "invalid sync manager settings", kLengths},
    Row{0x0018, "no valid inputs",
        "the drive cannot provide its values: check its own fault with `fault show`"},
    Row{0x0019, "no valid outputs", kFrames},
    Row{0x001A, "synchronisation error", kDc},
    Row{0x001B, "sync manager watchdog: no outputs received in time", kFrames},
    Row{0x001C, "invalid sync manager types",
        "the slave expects the sync managers in the order mailbox out, mailbox in, outputs, inputs"},
    Row{0x001D, "invalid output settings", kLengths},
    Row{0x001E, "invalid input settings", kLengths},
    Row{0x001F, "invalid watchdog settings",
        "the output watchdog is on without a time, or with one the drive does not accept"},
    Row{0x0020, "power cycle required", kPower},
    Row{0x0021, "slave requests INIT", "go to INIT with `state init`, then up again"},
    Row{0x0022, "slave requests PRE-OP", "go to PRE-OP with `state preop`, then up again"},
    Row{0x0023, "slave requests SAFE-OP", "go to SAFE-OP with `state safeop`, then up again"},
    Row{0x0024, "invalid input mapping", kMapping},
    Row{0x0025, "invalid output mapping", kMapping},
    Row{0x0026, "inconsistent settings", kMapping},
    Row{0x0027, "free run is not supported", kDc},
    Row{0x0028, "this kind of synchronisation is not supported", kDc},
    Row{0x0029, "free run needs sync managers with three buffers", kMapping},
    Row{0x002A, "background watchdog", kPower},
    Row{0x002B, "no valid inputs and outputs", kFrames},
    Row{0x002C, "fatal synchronisation error: SYNC signal lost", kDc},
    Row{0x002D, "no synchronisation: no SYNC signal received", kDc},
    Row{0x002E, "the cycle is too short", kCycle},
    Row{0x0030, "invalid SYNC0 or SYNC1 settings", kDc},
    Row{0x0031, "invalid DC latch settings", kDc},
    Row{0x0032, "it cannot lock to the network clock (PLL)", kDc},
    Row{0x0033, "inputs or outputs do not match the SYNC signal", kDc},
    Row{0x0034, "too many SYNC events without outputs", kFrames},
    Row{0x0035, "invalid SYNC cycle", kCycle},
    Row{0x0036, "SYNC0 cycle not accepted", kCycle},
    Row{0x0037, "SYNC1 cycle not accepted", kCycle},
    Row{0x0041, "mailbox error: ADS over EtherCAT", ""},
    Row{0x0042, "mailbox error: Ethernet over EtherCAT", ""},
    Row{0x0043, "mailbox error: CANopen over EtherCAT", "a setting written at each start was refused"},
    Row{0x0044, "mailbox error: file access over EtherCAT", ""},
    Row{0x0045, "mailbox error: servo drive profile over EtherCAT", ""},
    Row{0x004F, "mailbox error: the vendor's own protocol", ""},
    Row{0x0050, "no access to its SII", "going to INIT with `state init` and up again returns access"},
    Row{0x0051, "SII error", "rewrite the SII from the vendor's file"},
    Row{0x0052, "external hardware not ready", "is the drive's main supply on?"},
    Row{0x0060, "slave restarted locally",
        "did it lose its supply, or was it reset? start again with `state preop`"},
    Row{0x0061, "device identification value changed", ""},
    Row{0x0070, "detected modules do not match the configured ones",
        "its module list (F030h) must match what is installed"},
    Row{0x0080, "supply voltage too low", "check the supply"},
    Row{0x0081, "supply voltage too high", "check the supply"},
    Row{0x0082, "temperature too low", ""},
    Row{0x0083, "temperature too high", "let it cool down and check its fan"},
    Row{0x00F0, "application controller available", ""},
};

const Row* find(std::uint16_t code) {
  const auto row = std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return r.code == code; });
  return row == kRows.end() ? nullptr : &*row;
}

}  // namespace

std::string_view name(AlState state) {
  switch (state) {
    case AlState::init: return "INIT";
    case AlState::preop: return "PRE-OP";
    case AlState::boot: return "BOOT";
    case AlState::safeop: return "SAFE-OP";
    case AlState::op: return "OP";
    case AlState::none: break;
  }
  return "unknown state";
}

AlStatus parse_al_status(ByteSpan registers) {
  AlStatus out;
  if (registers.size() < reg::kAlStatusSize) return out;
  const auto status = word_at(registers, 0);
  out.state = static_cast<AlState>(status & reg::kAlStateMask);
  out.error = (status & reg::kAlError) != 0;
  out.code = word_at(registers, reg::kAlStatusCode - reg::kAlStatus);
  return out;
}

std::string al_status_text(std::uint16_t code) {
  const auto* row = find(code);
  if (row != nullptr) return std::string(row->text);
  return code >= kFirstOfVendor ? "vendor-specific code" : "code not listed in ETG.1000.6";
}

std::string al_status_hint(std::uint16_t code) {
  const auto* row = find(code);
  return row != nullptr ? std::string(row->hint) : "look the AL status code up in the drive's manual";
}

std::vector<std::uint16_t> al_status_codes() {
  std::vector<std::uint16_t> out;
  for (const auto& row : kRows) out.push_back(row.code);
  return out;
}

AlState next_al_state(AlState from, AlState target) {
  if (from == target) return target;
  if (target == AlState::boot || from == AlState::boot) return from == AlState::init ? target : AlState::init;
  if (from == AlState::init) return target < AlState::preop ? target : AlState::preop;
  if (from == AlState::preop && target > AlState::preop) return AlState::safeop;
  return target;
}

}  // namespace servoctl::ethercat
