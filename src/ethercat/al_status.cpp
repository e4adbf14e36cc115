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
    "the sync managers 0 and 1 are not what the slave expects: does its SII say where its mailboxes are? "
    "`scan` "
    "shows it";
constexpr std::string_view kLengths =
    "the length of the sync manager is not that of the assigned PDOs: `pdo show` shows what 1C12h, 1C13h and "
    "the "
    "mappings say";
constexpr std::string_view kMapping =
    "1C12h, 1C13h or a mapping names something that the drive does not take: `pdo show` shows them, a preset "
    "puts "
    "them right";
constexpr std::string_view kDc =
    "the drive works with distributed clocks (SYNC0) only, or with a cycle it does not like: look for its "
    "synchronisation (1C32h, 1C33h) in its manual";
constexpr std::string_view kCycle =
    "the drive does not take this cycle with distributed clocks: its manual lists the cycles";
constexpr std::string_view kFrames =
    "process data did not reach the drive in time: who cycles? Look for lost frames, a machine under load, a "
    "cable";
constexpr std::string_view kPower = "switch the drive off and on again";

constexpr std::array kRows{
    Row{0x0000, "no error", ""},
    Row{0x0001, "unspecified error", "look at the drive's own fault: `fault`"},
    Row{0x0002, "out of memory", kPower},
    Row{0x0003, "invalid device setup", "the modules or options of the drive do not fit its settings"},
    Row{0x0004, "invalid revision", "its firmware and its hardware do not belong together"},
    Row{0x0006, "its SII does not fit its firmware", "the SII has to be written anew with the vendor's file"},
    Row{0x0007, "its firmware update failed", "load the firmware again"},
    Row{0x000E, "licence error", ""},
    Row{0x0011, "invalid change of state requested",
        "states go up one at a time, INIT, PRE-OP, SAFE-OP, OP: was it already lower than thought?"},
    Row{0x0012, "unknown state requested", ""},
    Row{0x0013, "it has no bootstrap state", "it takes firmware another way"},
    Row{0x0014, "no valid firmware", "load a firmware, or load it again"},
    Row{0x0015, "invalid mailbox settings for the bootstrap state", kMailbox},
    Row{0x0016, "invalid mailbox settings for PRE-OP", kMailbox},
    Row{0x0017, "invalid settings of a sync manager", kLengths},
    Row{0x0018, "no valid inputs", "the drive cannot give its own values: look at its own fault: `fault`"},
    Row{0x0019, "no valid outputs", kFrames},
    Row{0x001A, "synchronisation error", kDc},
    Row{0x001B, "sync manager watchdog: no outputs came in time", kFrames},
    Row{0x001C, "invalid types of sync managers",
        "the sync managers are not used as the slave expects: mailbox out, mailbox in, outputs, inputs"},
    Row{0x001D, "invalid settings of the outputs", kLengths},
    Row{0x001E, "invalid settings of the inputs", kLengths},
    Row{0x001F, "invalid settings of the watchdog",
        "the watchdog of the outputs is on and has no time, or one the drive does not take"},
    Row{0x0020, "it must be switched off and on", kPower},
    Row{0x0021, "it asks for INIT", "`state init` and up again"},
    Row{0x0022, "it asks for PRE-OP", "`state preop` and up again"},
    Row{0x0023, "it asks for SAFE-OP", "`state safeop` and up again"},
    Row{0x0024, "invalid mapping of the inputs", kMapping},
    Row{0x0025, "invalid mapping of the outputs", kMapping},
    Row{0x0026, "settings that contradict each other", kMapping},
    Row{0x0027, "free run is not supported", kDc},
    Row{0x0028, "this kind of synchronisation is not supported", kDc},
    Row{0x0029, "free run needs sync managers with three buffers", kMapping},
    Row{0x002A, "background watchdog", kPower},
    Row{0x002B, "no valid inputs and outputs", kFrames},
    Row{0x002C, "fatal synchronisation error: its SYNC signal failed", kDc},
    Row{0x002D, "no synchronisation: its SYNC signal never came", kDc},
    Row{0x002E, "the cycle is too short", kCycle},
    Row{0x0030, "invalid settings of SYNC0 or SYNC1", kDc},
    Row{0x0031, "invalid settings of a DC latch", kDc},
    Row{0x0032, "it cannot follow the clock of the network (PLL)", kDc},
    Row{0x0033, "inputs or outputs do not fit the SYNC signal", kDc},
    Row{0x0034, "too many SYNC events without outputs", kFrames},
    Row{0x0035, "invalid SYNC cycle", kCycle},
    Row{0x0036, "the SYNC0 cycle does not fit the drive", kCycle},
    Row{0x0037, "the SYNC1 cycle does not fit the drive", kCycle},
    Row{0x0041, "mailbox error: ADS over EtherCAT", ""},
    Row{0x0042, "mailbox error: Ethernet over EtherCAT", ""},
    Row{0x0043, "mailbox error: CANopen over EtherCAT",
        "a setting that is written at each start was refused"},
    Row{0x0044, "mailbox error: file access over EtherCAT", ""},
    Row{0x0045, "mailbox error: servo drive profile over EtherCAT", ""},
    Row{0x004F, "mailbox error: the vendor's own protocol", ""},
    Row{0x0050, "it cannot get at its SII", "`state init` and up again gives it back"},
    Row{0x0051, "its SII has an error", "the SII has to be written anew with the vendor's file"},
    Row{0x0052, "hardware beside it is not ready", "has the drive its main supply?"},
    Row{0x0060, "it has restarted by itself",
        "did it lose its supply, or did somebody reset it? `state preop` begins anew"},
    Row{0x0061, "its identification value was changed", ""},
    Row{0x0070, "the modules it found are not those it was set to",
        "its list of modules (F030h) has to be what is there"},
    Row{0x0080, "supply voltage too low", "look at the supply"},
    Row{0x0081, "supply voltage too high", "look at the supply"},
    Row{0x0082, "temperature too low", ""},
    Row{0x0083, "temperature too high", "let it cool down, look at its fan"},
    Row{0x00F0, "its application controller is there", ""},
};
constexpr std::uint16_t kFirstOfVendor = 0x8000;

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
  return code >= kFirstOfVendor ? "a code of the vendor's own" : "a code that ETG.1000.6 does not list";
}

std::string al_status_hint(std::uint16_t code) {
  const auto* row = find(code);
  return row != nullptr ? std::string(row->hint) : "look the AL status code up in the drive's manual";
}

AlState next_al_state(AlState from, AlState target) {
  if (from == target) return target;
  if (target == AlState::boot || from == AlState::boot) return from == AlState::init ? target : AlState::init;
  if (from == AlState::init) return target < AlState::preop ? target : AlState::preop;
  if (from == AlState::preop && target > AlState::preop) return AlState::safeop;
  return target;
}

}  // namespace servoctl::ethercat
