#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "sim/esc_clock.hpp"
#include "sim/esc_memory.hpp"
#include "sim/esc_sii.hpp"
#include "sim/esc_sync_manager.hpp"
#include "sim/esc_watchdog.hpp"

namespace servoctl::sim {

/// The registers and the memory of an EtherCAT slave controller, and what happens when the master reads and
/// writes them. Its processor sees the same from the other side. Reads no clock.
class EscRegisters {
 public:
  static constexpr unsigned kSyncManagers = 8;
  static constexpr unsigned kFmmus = 4;
  static constexpr unsigned kRamKiB = 8;
  static constexpr unsigned kPorts = 2;
  /// Numbers of the sync managers, as every slave with a mailbox has them.
  static constexpr unsigned kMailboxOut = 0;
  static constexpr unsigned kMailboxIn = 1;
  static constexpr unsigned kOutputs = 2;
  static constexpr unsigned kInputs = 3;

  EscRegisters();
  void power_on(TimePoint now);
  void on_time(TimePoint now);
  TimePoint deadline() const;

  // The master. True when at least one of the bytes could be read, or written.
  bool read(std::uint32_t address, std::span<std::uint8_t> out);
  bool write(std::uint32_t address, ByteSpan data);
  /// What a byte holds that is about to be written in part.
  std::uint8_t peek(std::uint32_t address) const;
  /// A datagram is done: what it has asked of the controller itself begins.
  void finish_datagram(TimePoint now);
  /// A frame begins: registers that count by themselves show the present.
  void begin_frame(TimePoint now);

  // The processor.
  std::optional<std::uint16_t> take_al_control();
  void set_al_status(std::uint16_t status, std::uint16_t code);
  /// A sync manager was switched on or off since the last question.
  bool take_settings_changed();
  /// The master has written all outputs since the last question.
  bool take_outputs_written();
  /// The watchdog over the outputs has ended since the last question.
  bool take_outputs_missed();
  void stop_watchdog() { watchdog_.stop(); }
  Duration watchdog_period() const { return EscWatchdog::period(memory_); }
  EscSyncManager& sync_manager(unsigned number) { return managers_[number]; }
  const EscSyncManager& sync_manager(unsigned number) const { return managers_[number]; }
  bool has_sync0() const { return clock_.is_running(memory_); }
  bool is_sync0_set_up() const { return EscClock::is_set_up(memory_); }

  /// Of its distributed clock: 64, or 32 (0008h bit 3).
  void set_clock_bits(unsigned bits);

  // The wire.
  const EscMemory& memory() const { return memory_; }
  EscSii& sii() { return sii_; }
  /// A cable at this port, with somebody at its end. One that is taken away is counted (0310h).
  void set_link(unsigned port, bool linked);
  /// A frame came damaged at this port (0300h).
  void count_damage(unsigned port);
  /// A frame had lengths that do not fit (030Ch).
  void count_malformed();
  std::uint16_t station() const { return memory_.word(ethercat::reg::kStationAddress); }
  bool answers_to(std::uint16_t address) const;
  /// Frames that are not EtherCAT end here (0100h bit 0).
  bool destroys_foreign_frames() const;

 private:
  struct Run {
    EscSyncManager* manager = nullptr;
    std::size_t size = 0;
  };

  Run run_at(std::uint32_t address, std::size_t most);
  bool read_byte(std::uint32_t address, std::uint8_t& out) const;
  bool write_byte(std::uint32_t address, std::uint8_t value);
  bool write_manager(std::uint16_t address, std::uint8_t value);
  void clear_counters(std::uint16_t address);
  void count(std::uint16_t address);
  void show_features();

  EscMemory memory_;
  std::array<EscSyncManager, kSyncManagers> managers_;
  EscSii sii_;
  EscWatchdog watchdog_;
  EscClock clock_;
  std::array<bool, kPorts> links_{};
  bool al_written_ = false;
  bool sii_written_ = false;
  bool latch_written_ = false;
  bool activation_written_ = false;
  bool settings_changed_ = false;
  bool outputs_written_ = false;
  bool outputs_missed_ = false;
};

}  // namespace servoctl::sim
