#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/object_store.hpp"
#include "canopen/pdo.hpp"
#include "drive/profile.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// The PDOs of a simulated drive at work (CiA 301, 7.2.2): sends TPDOs at SYNC, when what they carry changes,
/// by their event timer and to whoever asks by a remote frame; takes RPDOs at once or at the next SYNC,
/// through the checks every write goes through. What its parameters say is looked up each time, so that a
/// change holds at once. Performs no I/O and reads no clock.
///
/// A remote frame is answered where bit 30 of the COB-ID allows it: by type 253 at once, by 252 with the
/// values of the last SYNC (or at the next, where the family's rules say so), by event-driven TPDOs when
/// their inhibit time is over (7.2.2.3: it is event-driven PDOs that are remotely requested). Synchronous
/// ones do not answer.
class PdoEngine {
 public:
  /// All outlive the engine. `store` gives and takes the mapped objects; `values` has the PDO parameters.
  PdoEngine(const drive::Profile& profile, const ObjectValues& values, canopen::ObjectStore& store);

  /// The drive has become operational: event-driven TPDOs are sent once (CiA 301, table 71).
  void start(TimePoint now);
  /// It is operational no longer.
  void stop();

  void on_frame(const can::Frame& frame, TimePoint now);
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  TimePoint deadline() const;

  /// Whether the last frame was a SYNC at which a synchronous RPDO wrote this object; false when asked again.
  bool take_synchronous(ObjectAddress object) { return synchronous_.erase(object) != 0; }

  /// Whether an RPDO came shorter than its mapping and was dropped, and none that fits has come since (CiA
  /// 301, table 26: 8210h).
  bool has_short_rpdo() const { return !short_.empty(); }
  /// … longer than its mapping, of which the first bytes were taken (8220h).
  bool has_long_rpdo() const { return !long_.empty(); }

 private:
  /// One PDO between its frames.
  struct Work {
    std::optional<TimePoint> sent;  ///< When a TPDO was last sent.
    std::optional<Bytes> data;      ///< What a TPDO last carried; what an RPDO brought for the next SYNC.
    std::uint32_t syncs = 0;        ///< Since a TPDO was last sent.
    bool started = false;           ///< The SYNC with the start value has come.
    bool requested = false;         ///< A remote frame asks for a TPDO that cannot be sent yet.
  };

  canopen::Pdo read_pdo(canopen::PdoDirection direction, std::uint16_t number) const;
  void on_sync(const can::Frame& frame, TimePoint now);
  void on_sync(const canopen::Pdo& pdo, std::optional<std::uint8_t> counter, TimePoint now);
  void on_sync_by_request(const canopen::Pdo& pdo, TimePoint now);
  void on_request(const can::Frame& frame, TimePoint now);
  void on_request(const canopen::Pdo& pdo, TimePoint now);
  void on_receive(const canopen::Pdo& pdo, const can::Frame& frame);
  void check_events(const canopen::Pdo& pdo, TimePoint now);
  void apply(const canopen::Pdo& pdo, ByteSpan data);
  Bytes sample(const canopen::Pdo& pdo);
  void transmit(const canopen::Pdo& pdo, Bytes data, TimePoint now);
  Work& work(const canopen::Pdo& pdo) { return work_[pdo.communication_index()]; }

  const drive::Profile* profile_;
  const ObjectValues* values_;
  canopen::ObjectStore* store_;
  std::vector<canopen::Pdo> known_;  ///< Direction and number of those the drive has.
  std::map<std::uint16_t, Work> work_;
  bool operational_ = false;
  TimePoint next_look_ = kNever;
  std::set<std::uint16_t> short_;        ///< Communication records of RPDOs whose last frame was too short.
  std::set<std::uint16_t> long_;         ///< … was too long.
  std::set<ObjectAddress> synchronous_;  ///< Written by synchronous RPDOs at the last SYNC.
  std::deque<can::Frame> tx_;
};

}  // namespace servoctl::sim
