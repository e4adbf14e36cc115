#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "drive/caution.hpp"
#include "drive/cia402.hpp"
#include "drive/modbus_rules.hpp"
#include "drive/pdo_recipe.hpp"
#include "drive/power_parameter.hpp"
#include "drive/scaling.hpp"
#include "od/doubts.hpp"

namespace servoctl::drive {

/// An object that must hold a value.
struct Condition {
  ObjectAddress object;
  std::uint64_t value = 0;
};

/// What an object of the identity (1000h, 1008h, 1018h) says on every drive of a family.
struct IdentityMark {
  ObjectAddress object;
  std::uint64_t value = 0;
  std::uint64_t mask = ~std::uint64_t{0};  ///< Bits of the value that count.
  std::string text;   ///< Of an object that is a text, instead of `value`; empty: it is a number.
  bool soft = false;  ///< Another value is told, and contradicts nothing.
};

/// A parameter or object by name (`Fn_99`, `0x2005:01`), and what to write to it.
struct Setting {
  std::string name;
  std::int64_t value = 0;
};

/// How panel numbers map to objects: number n stands at `index + n / block`, sub-index `n % block +
/// first_sub`. `group` is for numbers in two parts: `P5.37` is number 5 × group + 37.
struct Numbering {
  std::string prefix;
  std::uint16_t index = 0;
  std::uint32_t base = 10;  ///< 16: the digits are hexadecimal.
  std::uint32_t group = 0;
  std::uint32_t block = 1;
  std::uint8_t first_sub = 0;
  bool unlisted = false;  ///< The rule holds for numbers the parameter table does not list as well.
  bool read_only = false;

  /// The number in the id, `37` of `Pn0037`; empty when the id is not of this kind.
  std::optional<std::uint32_t> number(std::string_view id) const;
  ObjectAddress object(std::uint32_t number) const;
};

/// Bits 10 to 15 of the statusword in one mode of operation while the drive is not enabled.
struct ModeBits {
  std::int8_t mode = 0;
  std::uint16_t disabled = 0;
};

struct SdoRules {
  bool segmented = true;
  bool block = true;  ///< Needs `segmented`.
  bool exact_length = true;
  bool echoes_data = false;  ///< The acknowledge of a write carries its data.
  /// Objects of which the drive takes the bytes of an expedited download in their own size, although its
  /// command announces fewer.
  std::vector<ObjectAddress> short_writes;
};

struct NmtRules {
  /// What puts a new node-ID or bitrate in force.
  enum class Restart : std::uint8_t { power_cycle, reset_node, reset_communication };
  std::string node_id;  ///< Parameter of the node-ID.
  std::string bitrate;  ///< Parameter of the bitrate: its labels are bitrates, or its unit is kbit/s.
  Restart address_after = Restart::power_cycle;
  std::string autostart;       ///< Parameter: 1 goes to Operational by itself.
  std::string guarding_alarm;  ///< Parameter: 0, the end of life guarding raises no fault.
  std::uint32_t max_nodes = 127;
  std::vector<Setting> needs;  ///< What must be set before the drive listens to CANopen at all.
  bool disables_outside_operational = false;
  std::vector<std::string> lost_alarms;  ///< Panel texts of what the manual calls a lost communication.
};

/// `power cycle`, `reset node`, `reset communication`.
std::string_view name(NmtRules::Restart restart);

/// What may be changed of a PDO, and when (CiA 301, 7.5.2.33 to 7.5.2.38, and the vendor's narrower rules).
struct PdoRules {
  enum class When : std::uint8_t { always, invalid, not_operational };
  std::uint32_t cob_id_bits = 0xFFFF'FFFF;  ///< Bits of the COB-ID that may change.
  When parameters = When::always;           ///< When transmission type and times may change.
  When mapping = When::always;
  bool inhibit_while_valid = false;  ///< Inhibit time and SYNC start value may change while the PDO is valid.
  bool clears_entries = false;       ///< Count 0 clears the entries as well.
  bool disable_by_count = false;     ///< The mapping is opened by count 0 alone; the COB-ID stays valid.
  std::uint8_t most_entries = 64;
  std::uint16_t most_bits = 64;
  bool whole_bytes = false;
  /// Abort code of an entry that is written while the count of its mapping is not 0 (CiA 301, 7.5.2.36,
  /// leaves it open: stacks answer 0601 0000h or 0800 0000h).
  std::uint32_t mapped_abort = 0x0601'0000;
  std::vector<std::int64_t> refused_types;  ///< Transmission types the drive does not know.
  /// What vendor-specific types mean here, in words; `on change` and `by the event timer` say that nothing
  /// else makes the drive send, `at the SYNC after a remote frame` when it answers one.
  std::map<std::int64_t, std::string> types;
  std::vector<PdoPreset> presets;
  std::string assign_rpdo;  ///< Object that chooses among fixed PDOs (CoE 1C12h, 1C13h).
  std::string assign_tpdo;

  /// Whether a TPDO of this event-driven type (254, 255) is sent when what it carries changes, and when its
  /// event timer ends.
  bool sends_on_change(std::uint8_t type) const { return !says(type, "by the event timer"); }
  bool sends_by_timer(std::uint8_t type) const { return !says(type, "on change"); }
  /// Whether a TPDO that was asked for by a remote frame is sent at the next SYNC (type 252; by CiA 301 it is
  /// sent at once, with the values of the last SYNC).
  bool answers_at_sync(std::uint8_t type) const { return says(type, "at the SYNC after a remote frame"); }

 private:
  bool says(std::uint8_t type, std::string_view words) const {
    const auto found = types.find(type);
    return found != types.end() && found->second == words;
  }
};

/// A piece of the memory of an EtherCAT slave.
struct EscArea {
  std::uint16_t start = 0;
  std::uint16_t size = 0;  ///< Bytes; 0: there is none.
};

/// How the objects are reached over EtherCAT (CoE), where the drive's own SII does not tell it. Out and in
/// are the master's.
struct CoeRules {
  EscArea mailbox_out;
  EscArea mailbox_in;
  std::uint16_t outputs = 0;  ///< Where the process data begin; how many there are says the mapping.
  std::uint16_t inputs = 0;
  std::uint16_t rpdo = 0;  ///< What is assigned for motions where 1C12h does not carry 6040h; 0: nothing.
  std::uint16_t tpdo = 0;  ///< The same for 1C13h and 6041h.
  bool sdo_info = false;   ///< It lists and describes its objects.
  bool complete_access = false;  ///< All sub-indices of an object go in one transfer.

  bool exists() const { return mailbox_out.size != 0 && mailbox_in.size != 0; }
};

/// How values survive power-off.
struct StoreRules {
  std::vector<Setting> store;    ///< Beside 1010h.
  std::vector<Setting> restore;  ///< Beside 1011h.
  bool objects = true;           ///< 1010h and 1011h do it.
  std::string flash_switch;      ///< Parameter that says whether writes go to the flash at once.
  std::optional<std::int64_t> to_ram;
  std::optional<std::int64_t> to_flash;
  bool wears = false;  ///< Every write to the flash wears it.
  std::string unlock;  ///< Parameter that holds the password.
  std::optional<std::int64_t> unlock_open;
  std::optional<std::int64_t> unlock_closed;
  std::vector<std::string> locked;  ///< Parameters the password guards.
  bool locks(std::string_view parameter) const {
    return std::find(locked.begin(), locked.end(), parameter) != locked.end();
  }
  std::string restore_at_start;       ///< Parameter: 1 restores the defaults at the next start.
  std::string clear_alarms_at_start;  ///< Parameter: 1 clears the alarm records at the next start.
  /// A value that needs standstill is taken while the drive is enabled, and takes effect once it is disabled;
  /// false: it is refused.
  bool defers_standstill = false;
};

/// How the counts per motor revolution are measured where no object gives them.
struct LearnRules {
  std::string speed;  ///< Parameter or object that shows the speed of the motor in rpm; empty: there is none.
  double least = 0;   ///< The drive has no fewer counts in a turn: how fast it may be told to turn at first.
};

/// How the drive is moved. Modes are numbers of 6060h; empty where it has none.
struct MotionRules {
  std::optional<std::int8_t> position;
  std::optional<std::int8_t> velocity;
  std::optional<std::int8_t> torque;
  std::optional<std::int8_t> homing;
  std::vector<std::uint16_t> enable{0x06, 0x07, 0x0F};
  std::vector<std::uint16_t> start_homing{0x0F, 0x1F};
  std::uint16_t homing_done_mask = 0x3400;  ///< Bits 10, 12, 13 of the statusword.
  std::uint16_t homing_done = 0x1400;
  std::uint16_t homing_error = 0x2000;
  std::string encoder = "0x6063";  ///< Counts of the motor's encoder, which homing leaves alone.
  bool homed_bit = false;          ///< Bit 15 of the statusword says that the axis is homed.
  bool halt = true;                ///< Bit 8 of the controlword.
  bool handshake = true;  ///< Bit 4 of the controlword takes a target; false: 607Ah is followed at once.
  std::string position_speed = "0x6081";  ///< Object that holds the speed of a move to a position.
  std::string rated_speed;                ///< Object or parameter that holds the rated speed of the motor.
  std::string rated_torque;  ///< Object or parameter with the rated torque in the unit of 6071h, if not in %.
  std::vector<std::uint8_t> inputs{0, 1, 2};    ///< Bits of 60FDh: negative limit, positive limit, home.
  std::vector<std::uint8_t> inputs_active_low;  ///< Bits of 60FDh that are 0 while their switch is actuated.
  bool inputs_known = false;  ///< The family states one of the two, or that it assumes the level.

  /// Whether the switch behind this bit of 60FDh is actuated: an axis at its limit, or on its home switch.
  bool is_actuated(std::uint32_t inputs_word, unsigned bit) const;
  std::vector<std::int64_t> no_homing;  ///< Values of 6098h that do nothing.
  /// Values of 6098h that move like another method of CiA 402-2 than the one of the same number.
  std::map<std::int64_t, std::int64_t> homing_like;
  std::optional<Condition> software_limits;  ///< 607Dh acts only while this holds.
  bool software_limits_homed = false;        ///< 607Dh acts only once the axis is homed.
  std::uint32_t zero_ramp = 0;               ///< What a ramp of 0 (6083h to 6085h) counts as.
  std::vector<std::string> speed_limit;      ///< What limits the speed in torque mode.
  std::optional<std::uint32_t> setpoints;    ///< Targets the drive can hold.
  std::vector<PowerParameter> without_controlword;
  std::string speed_monitor;  ///< Parameter that shows the speed of the motor in rpm.
  /// Where it has two values, least and greatest: in interpolated position the drive takes 60C1h:01 at each
  /// SYNC, by a synchronous RPDO only, and moves there in the period of 60C2h, limited to these milliseconds.
  std::vector<std::uint16_t> interpolation_ms;
};

/// How an emergency message names the alarm of the panel.
struct EmergencyRules {
  std::uint16_t drive_alarm = 0xFF00;  ///< The code of most alarms of the drive.
  std::uint8_t size = 8;               ///< Bytes the drive sends.
  std::string panel;  ///< Text of the panel, `Er{major}-{minor}`; empty when the bytes do not tell.
  std::uint8_t major_byte = 3;
  std::uint8_t minor_byte = 4;
};

struct FaultRules {
  std::optional<Condition> reset_enabled_by;
  std::vector<Setting> reset;  ///< What resets a fault beside the controlword.
  bool by_controlword = true;
  std::string alarm;  ///< Parameter or object that holds the panel's alarm number.
  /// Object by whose ramp the reaction stops the motor; empty: it is de-energised at once.
  std::string ramp;
  std::string length_alarm;     ///< Panel text of the alarm a write of a wrong length raises.
  std::string mapping_alarm;    ///< … of mapping in Operational.
  std::string range_alarm;      ///< … of a value out of range.
  std::string access_alarm;     ///< … of a write to what cannot be written.
  std::string object_alarm;     ///< … of a read or write of an object that the drive does not have.
  std::string sub_index_alarm;  ///< … of a sub-index that its object does not have.
  std::string following_alarm;  ///< … of a following error; empty: 8611h (CiA 402-2).
};

/// The manual's own words for an abort code; empty in the language it does not use.
struct AbortText {
  std::string text;
  std::string text_zh;
};

/// Stands for a ramp: the motor slows down with the greatest torque of the drive.
inline constexpr std::string_view kMostTorque = "most torque";

/// What `<family>.toml` says: the rules of a family that no table can carry. Parameters are named by their
/// id. docs/drive-data.md describes every key.
struct Rules {
  std::string family;
  std::string parent;  ///< Family whose files hold where this one has none.
  std::string vendor;
  std::string name;
  std::string name_zh;

  std::vector<IdentityMark> identity;  ///< All must hold.
  bool identity_certain = false;       ///< False: a match is a guess, to be offered and never assumed.
  /// Whatever matches is of this family or of one that answers like it: enough to take the user's word, and
  /// to contradict the name of another family. Always so where a match is certain.
  bool identity_telling = false;
  /// Objects of their own that its drives have and few others: where `identity` does not tell, they are
  /// looked for by reading. All there: it is one of the family or like it; none: it is none.
  std::vector<ObjectAddress> identity_looks;

  std::vector<Numbering> numbering;
  std::map<Measure, Quotients> units;
  LearnRules learn;
  SdoRules sdo;
  NmtRules nmt;
  PdoRules pdo;
  CoeRules coe;
  ModbusRules modbus;
  StoreRules store;
  MotionRules motion;
  EmergencyRules emergency;
  FaultRules fault;
  std::vector<Caution> cautions;

  std::vector<ObjectAddress> mirror_add_node_id;
  /// By DriveState, fault last; by default those of CiA 402-2 with bits 4 and 9 set.
  std::array<std::uint16_t, 8> statusword{0x0000, 0x0250, 0x0231, 0x0233, 0x0237, 0x0217, 0x021F, 0x0218};
  bool remote_bit = true;  ///< Bit 9 (remote) of the statusword says whether the drive obeys the bus.
  std::vector<ModeBits> mode_bits;
  std::vector<std::int64_t> quick_stop_stays_enabled;
  /// Values of 605Ah that slow the motor down: the object that holds the ramp, or kMostTorque. By any other
  /// value it is de-energised at once. 0 stands for a drive without 605Ah.
  std::map<std::int64_t, std::string> quick_stop_ramps;

  std::map<std::uint32_t, AbortText> abort_texts;
  std::vector<std::string> assumed;  ///< Sections, or keys as `section.key`, the manual does not state.
  /// Whether this very entry stands among them.
  bool is_assumed(std::string_view key) const;
  std::vector<od::Mark> contradicted;  ///< As `section.key`: the manual says otherwise elsewhere.
};

/// Reads a rules file on top of `base`, the rules of its parent. Errc::file with file and line for a syntax
/// error, an unknown key or a value of the wrong kind: a rule that is misspelt would silently not hold.
Result<Rules> parse_rules(std::string_view toml, std::string_view file, Rules base = {});
/// The same of all that is right; adds everything that is wrong to `errors`. Of a text that is no TOML only
/// the first fault of its form is known.
Rules read_rules(std::string_view toml, std::string_view file, Rules base, std::vector<Error>& errors);

/// The name of the parent in a rules file, without reading the rest; empty when it has none or is no TOML.
std::string parent_of(std::string_view toml);

}  // namespace servoctl::drive
