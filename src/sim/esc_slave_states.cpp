// What a slave must have before it goes to a state, and what happens when it does.
#include <algorithm>

#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/cia402.hpp"
#include "ethercat/registers.hpp"
#include "sim/esc_slave.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;
namespace reg = ethercat::reg;

namespace {

/// Below it a request of SDO and its answer have no room.
constexpr std::uint16_t kLeastMailbox = 34;
/// Three buffers stand one behind the other.
constexpr std::uint32_t kBuffers = 3;
/// EtherCAT's own abort codes.
constexpr std::uint32_t kCountNotZero = 0x0601'0003;
constexpr std::uint32_t kMappedToOutputs = 0x0601'0006;
/// Of a life guarding error (CiA 301, table 26), where the family names none.
constexpr std::uint16_t kMasterLost = 0x8130;

struct MemoryPlace {
  std::uint32_t first = 0;
  std::uint32_t behind = 0;
};

MemoryPlace place_of(const EscSyncManager& manager) {
  const auto length = manager.length() * (manager.is_buffered() ? kBuffers : 1U);
  return {manager.start(), manager.start() + length};
}

}  // namespace

/// Whether the area of a sync manager is in the memory, and in none of those before it.
bool EscSlave::lies_free(unsigned number) const {
  constexpr std::uint32_t kEnd = reg::kProcessMemory + EscRegisters::kRamKiB * 1024;
  const auto mine = place_of(registers().sync_manager(number));
  if (mine.first < reg::kProcessMemory || mine.behind > kEnd) return false;
  for (unsigned other = 0; other < number; ++other) {
    const auto& manager = registers().sync_manager(other);
    const auto its = place_of(manager);
    if (manager.is_enabled() && mine.first < its.behind && its.first < mine.behind) return false;
  }
  return true;
}

std::uint16_t EscSlave::check_mailboxes() const {
  const auto& rules = model_.profile().rules.coe;
  const auto fits = [&](unsigned number, bool master_writes, std::uint16_t most) {
    const auto& manager = registers().sync_manager(number);
    return manager.is_enabled() && manager.is_mailbox() && manager.master_writes() == master_writes &&
           manager.length() >= kLeastMailbox && manager.length() <= most && lies_free(number);
  };
  const bool fine = fits(EscRegisters::kMailboxOut, true, rules.mailbox_out.size) &&
                    fits(EscRegisters::kMailboxIn, false, rules.mailbox_in.size);
  return fine ? al_code::kNone : al_code::kMailbox;
}

std::uint16_t EscSlave::check_process_data() {
  if (const auto code = process_data_.load(); code != 0) return code;
  const auto fits = [&](unsigned number, bool master_writes, std::size_t size) {
    const auto& manager = registers().sync_manager(number);
    if (size == 0) return !manager.is_enabled();
    return manager.is_enabled() && manager.is_buffered() && manager.master_writes() == master_writes &&
           manager.length() == size && lies_free(number);
  };
  if (!fits(EscRegisters::kOutputs, true, process_data_.output_size())) return al_code::kOutputs;
  if (!fits(EscRegisters::kInputs, false, process_data_.input_size())) return al_code::kInputs;
  for (unsigned number = EscRegisters::kInputs + 1; number < EscRegisters::kSyncManagers; ++number)
    if (registers().sync_manager(number).is_enabled()) return al_code::kSyncManager;
  return al_code::kNone;
}

std::uint16_t EscSlave::check_synchronisation() const {
  if (!faults_.refuses_free_run) return al_code::kNone;
  if (!registers().is_sync0_set_up()) return al_code::kNoFreeRun;
  return registers().has_sync0() ? al_code::kNone : al_code::kNoSync;
}

bool EscSlave::outputs_arrive() const { return outputs_seen_ || process_data_.output_size() == 0; }

void EscSlave::on_state(EscState from, EscState to) {
  coe_.set_asleep(faults_.sleeps_outside_op && to != EscState::op);
  if (from == EscState::op) leave_op(master_lost_);
  if (from >= EscState::safe_op && to < EscState::safe_op) {
    registers().stop_watchdog();
    outputs_seen_ = false;
  }
  if (to == EscState::init || from == EscState::init) {
    coe_.reset();
    mailbox_.stop();
  }
  if (from == EscState::init) mailbox_.start();
  if (to != EscState::op) return;
  model_.set_operational(true);
  apply_outputs();
}

/// A drive that still has power when its process data end has lost who moves it.
void EscSlave::leave_op(bool by_watchdog) {
  model_.set_operational(false);
  const bool has_power = drive::is_energised(model_.power_state());
  if (by_watchdog || has_power) model_.on_master_lost(lost_code(), model_.now());
}

/// That of the alarm which the family's manual calls a lost communication.
std::uint16_t EscSlave::lost_code() const {
  const auto& alarms = model_.profile().rules.nmt.lost_alarms;
  for (const auto& fault : model_.profile().faults)
    if (fault.code && std::find(alarms.begin(), alarms.end(), fault.panel) != alarms.end())
      return *fault.code;
  return kMasterLost;
}

std::uint32_t EscSlave::check_write(ObjectAddress object, ByteSpan data) const {
  if (applies_) return 0;
  const bool in_op = state() == EscState::op;
  if (in_op && faults_.refuses_mapped_writes && process_data_.carries_output(object)) return kMappedToOutputs;
  const bool assigns =
      object.index != 0 && (object.index == assign_outputs_ || object.index == assign_inputs_);
  if (!assigns && !is_pdo_mapping(object.index)) return 0;
  if (state() > EscState::pre_op) return abort::kDeviceState;
  return assigns ? check_assignment(object, data) : 0;
}

/// 1C12h and 1C13h: a count of 0 opens them, and each entry names a PDO of the right direction (ETG.1000.6,
/// 5.6.7.4).
std::uint32_t EscSlave::check_assignment(ObjectAddress object, ByteSpan data) const {
  const auto& values = model_.values();
  const auto value = load_le(data);
  if (object.sub == 0) {
    for (std::uint8_t sub = 1; sub <= value; ++sub)
      if (values.number({object.index, sub}) == 0) return abort::kPdoLength;
    return 0;
  }
  if (values.number({object.index, 0}) != 0) return kCountNotZero;
  const auto index = static_cast<std::uint16_t>(value);
  const auto place = pdo_at(index);
  const auto direction = object.index == assign_outputs_ ? PdoDirection::receive : PdoDirection::transmit;
  const bool names_one = place && place->mapping && place->direction == direction && values.has({index, 0});
  return value == 0 || names_one ? 0 : abort::kRange;
}

}  // namespace servoctl::sim
