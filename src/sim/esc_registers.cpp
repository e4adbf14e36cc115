#include "sim/esc_registers.hpp"

#include <algorithm>
#include <utility>

#include "ethercat/registers.hpp"

namespace servoctl::sim {
namespace reg = ethercat::reg;

namespace {

constexpr std::uint32_t kMemoryEnd = reg::kProcessMemory + EscRegisters::kRamKiB * 1024;

struct Range {
  std::uint16_t first;
  std::uint16_t last;
};

/// What the master may write below 1000h, beside the SII interface and the sync managers.
constexpr Range kWritable[] = {
    {reg::kStationAddress, reg::kStationAddress + 1},
    {reg::kDlControl, reg::kDlControlAlias},
    {reg::kAlControl, reg::kAlControl + 1},
    {0x0200, 0x0201},  // Which events stand in the interrupts of a datagram.
    {reg::kErrorCounters, 0x0313},
    {reg::kWatchdogDivider, reg::kWatchdogDivider + 1},
    {reg::kPdiWatchdog, reg::kPdiWatchdog + 1},
    {reg::kSmWatchdog, reg::kSmWatchdog + 1},
    {reg::kSmWatchdogCounter, reg::kSmWatchdogCounter + 1},
    {reg::kFmmu, reg::kFmmu + EscRegisters::kFmmus* reg::kFmmuSize - 1},
    {reg::kDcReceiveTimes, reg::kDcReceiveTimes + 3},
    {reg::kDcSystemTime, reg::kDcSystemTime + 7},
    {reg::kDcOffset, reg::kDcDelay + 3},
    {reg::kDcSpeedStart, reg::kDcFilter + 1},
    {reg::kDcCyclicControl, reg::kDcActivation},
    {reg::kDcStart, reg::kDcStart + 7},
    {reg::kDcSync0Cycle, reg::kDcSync1Cycle + 3},
};

constexpr bool is_between(std::uint32_t address, std::uint32_t first, std::size_t size) {
  return address >= first && address < first + size;
}
constexpr bool is_of_manager(std::uint32_t address) {
  return is_between(address, reg::kSyncManager, EscRegisters::kSyncManagers * reg::kSyncManagerSize);
}
constexpr bool is_of_sii(std::uint32_t address) { return is_between(address, reg::kSiiAccess, 16); }

}  // namespace

EscRegisters::EscRegisters() { power_on({}); }

void EscRegisters::power_on(TimePoint now) {
  constexpr std::uint8_t kTwoPlugs = 0x0F;
  memory_.clear();
  memory_[reg::kType] = 0x11;
  memory_.set(reg::kType + 2, 2, 2);
  memory_[reg::kFmmuCount] = kFmmus;
  memory_[reg::kSyncManagers] = kSyncManagers;
  memory_[reg::kRamSize] = kRamKiB;
  memory_[reg::kPorts] = kTwoPlugs;
  show_features();
  memory_[reg::kDlControl] = reg::kDlControlForward;
  memory_.set(reg::kWatchdogDivider, reg::kDefaultWatchdogDivider, 2);
  memory_.set(reg::kPdiWatchdog, reg::kDefaultSmWatchdog, 2);
  memory_.set(reg::kSmWatchdog, reg::kDefaultSmWatchdog, 2);
  for (auto& manager : managers_) manager.reset();
  watchdog_.reset();
  clock_.reset();
  al_written_ = sii_written_ = latch_written_ = activation_written_ = false;
  settings_changed_ = outputs_written_ = outputs_missed_ = false;
  sii_.power_on(memory_);
  const auto links = std::exchange(links_, {});
  for (unsigned port = 0; port < kPorts; ++port) set_link(port, links[port]);
  begin_frame(now);
}

void EscRegisters::set_clock_bits(unsigned bits) {
  clock_.set_bits(bits);
  show_features();
}

void EscRegisters::show_features() {
  constexpr unsigned kWide = 64;
  memory_.set(reg::kFeatures, reg::kFeatureDc | (clock_.bits() == kWide ? reg::kFeatureDc64 : 0U), 2);
}

void EscRegisters::on_time(TimePoint now) {
  sii_.on_time(memory_, now);
  if (watchdog_.on_time(now)) outputs_missed_ = true;
}

TimePoint EscRegisters::deadline() const { return std::min(sii_.deadline(), watchdog_.deadline()); }

void EscRegisters::begin_frame(TimePoint now) {
  clock_.show(memory_, now);
  memory_[reg::kSmWatchdogStatus] = watchdog_.is_content(memory_) ? 1 : 0;
  memory_[reg::kSmWatchdogCounter] = watchdog_.count();
}

EscRegisters::Run EscRegisters::run_at(std::uint32_t address, std::size_t most) {
  if (address < reg::kProcessMemory)
    return {nullptr, std::min<std::size_t>(most, reg::kProcessMemory - address)};
  for (auto& manager : managers_)
    if (manager.covers(address))
      return {&manager, std::min<std::size_t>(most, manager.start() + manager.length() - address)};
  for (const auto& manager : managers_)
    if (manager.is_enabled() && manager.length() != 0 && manager.start() > address)
      most = std::min<std::size_t>(most, manager.start() - address);
  return {nullptr, most};
}

bool EscRegisters::read(std::uint32_t address, std::span<std::uint8_t> out) {
  bool any = false;
  while (!out.empty()) {
    const auto run = run_at(address, out.size());
    const auto part = out.first(run.size);
    if (run.manager != nullptr)
      any = run.manager->read(address - run.manager->start(), part) || any;
    else
      for (std::size_t i = 0; i < part.size(); ++i)
        any = read_byte(static_cast<std::uint32_t>(address + i), part[i]) || any;
    address += static_cast<std::uint32_t>(run.size);
    out = out.subspan(run.size);
  }
  return any;
}

bool EscRegisters::write(std::uint32_t address, ByteSpan data) {
  bool any = false;
  while (!data.empty()) {
    const auto run = run_at(address, data.size());
    const auto part = data.first(run.size);
    if (run.manager != nullptr)
      any = run.manager->write(address - run.manager->start(), part) || any;
    else
      for (std::size_t i = 0; i < part.size(); ++i)
        any = write_byte(static_cast<std::uint32_t>(address + i), part[i]) || any;
    address += static_cast<std::uint32_t>(run.size);
    data = data.subspan(run.size);
  }
  return any;
}

bool EscRegisters::read_byte(std::uint32_t address, std::uint8_t& out) const {
  if (address >= kMemoryEnd) return false;
  const auto at = static_cast<std::uint16_t>(address);
  if (is_of_manager(at))
    out = managers_[(at - reg::kSyncManager) / reg::kSyncManagerSize].register_at(at % reg::kSyncManagerSize);
  else
    out = memory_[at];
  return true;
}

std::uint8_t EscRegisters::peek(std::uint32_t address) const {
  for (const auto& manager : managers_)
    if (manager.covers(address)) return manager.peek(address - manager.start());
  return address < EscMemory::kSize ? memory_[static_cast<std::uint16_t>(address)] : std::uint8_t{0};
}

bool EscRegisters::write_byte(std::uint32_t address, std::uint8_t value) {
  if (address >= kMemoryEnd) return false;
  const auto at = static_cast<std::uint16_t>(address);
  if (is_of_manager(at)) return write_manager(at, value);
  if (is_of_sii(at) && !sii_.is_writable(memory_, at)) return false;
  const auto allowed = [at](Range range) { return at >= range.first && at <= range.last; };
  if (at < reg::kProcessMemory && !is_of_sii(at) &&
      std::none_of(std::begin(kWritable), std::end(kWritable), allowed))
    return false;
  if (at >= reg::kErrorCounters && at < reg::kWatchdogDivider) {
    clear_counters(at);
    return true;
  }
  if (at == reg::kSmWatchdogCounter) watchdog_.clear_count();
  if (is_between(at, reg::kSmWatchdogCounter, 2)) return true;
  if (is_between(at, reg::kDcReceiveTimes, 4)) {
    latch_written_ = true;
    return true;
  }
  if (is_between(at, reg::kDcSystemTime, 8)) return true;  // It keeps the time already.
  al_written_ = al_written_ || at == reg::kAlControl;
  sii_written_ = sii_written_ || is_between(at, reg::kSiiControl, 2);
  activation_written_ = activation_written_ || at == reg::kDcActivation;
  memory_[at] = value;
  return true;
}

bool EscRegisters::write_manager(std::uint16_t address, std::uint8_t value) {
  auto& manager = managers_[(address - reg::kSyncManager) / reg::kSyncManagerSize];
  const bool was = manager.is_enabled();
  const bool done = manager.write_register(address % reg::kSyncManagerSize, value);
  settings_changed_ = settings_changed_ || was != manager.is_enabled();
  return done;
}

void EscRegisters::finish_datagram(TimePoint now) {
  if (std::exchange(sii_written_, false)) sii_.on_command(memory_, now);
  if (std::exchange(latch_written_, false)) clock_.latch(memory_, now);
  if (std::exchange(activation_written_, false)) clock_.activate(memory_, now);
  auto& outputs = managers_[kOutputs];
  if (!outputs.is_buffered() || !outputs.take_written()) return;
  outputs_written_ = true;
  if (outputs.has_watchdog()) watchdog_.trigger(memory_, now);
}

std::optional<std::uint16_t> EscRegisters::take_al_control() {
  if (!std::exchange(al_written_, false)) return std::nullopt;
  return memory_.word(reg::kAlControl);
}

void EscRegisters::set_al_status(std::uint16_t status, std::uint16_t code) {
  memory_.set(reg::kAlStatus, status, 2);
  memory_.set(reg::kAlStatusCode, code, 2);
}

bool EscRegisters::take_settings_changed() { return std::exchange(settings_changed_, false); }

bool EscRegisters::take_outputs_written() { return std::exchange(outputs_written_, false); }

bool EscRegisters::take_outputs_missed() { return std::exchange(outputs_missed_, false); }

void EscRegisters::set_link(unsigned port, bool linked) {
  constexpr unsigned kProcessorWorks = 0x0003;
  if (links_[port] && !linked) count(static_cast<std::uint16_t>(reg::kLostLinks + port));
  links_[port] = linked;
  unsigned status = kProcessorWorks + reg::dl_loop(2) + reg::dl_loop(3);
  for (unsigned each = 0; each < kPorts; ++each) {
    const unsigned joined = reg::dl_link(each) + unsigned{reg::dl_signal(each)};
    status |= links_[each] ? joined : reg::dl_loop(each);
  }
  memory_.set(reg::kDlStatus, status, 2);
}

void EscRegisters::count(std::uint16_t address) {
  if (memory_[address] < 0xFF) ++memory_[address];
}

void EscRegisters::count_damage(unsigned port) {
  count(static_cast<std::uint16_t>(reg::kRxErrors + 2 * port));
}

void EscRegisters::count_malformed() { count(reg::kProcessingErrors); }

/// Those of the receivers go together, and those of the links.
void EscRegisters::clear_counters(std::uint16_t address) {
  const auto clear = [&](std::uint16_t first, std::uint16_t behind) {
    if (address >= first && address < behind)
      for (auto at = first; at < behind; ++at) memory_[at] = 0;
  };
  clear(reg::kRxErrors, reg::kProcessingErrors);
  clear(reg::kProcessingErrors, reg::kPdiErrors);
  clear(reg::kPdiErrors, reg::kPdiErrors + 1);
  clear(reg::kLostLinks, reg::kLostLinks + 4);
}

bool EscRegisters::answers_to(std::uint16_t address) const {
  const bool by_alias = (memory_[reg::kDlControlAlias] & 1U) != 0;
  return address == station() || (by_alias && address == memory_.word(reg::kStationAlias));
}

bool EscRegisters::destroys_foreign_frames() const {
  return (memory_[reg::kDlControl] & reg::kDlControlForward) != 0;
}

}  // namespace servoctl::sim
