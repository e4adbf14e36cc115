#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "sim/esc_slave.hpp"

namespace servoctl::sim {

/// What goes wrong on the wire; nothing at first. Frames are numbered from 1, as the master sends them.
struct RingFaults {
  /// Where a frame is damaged: on the cable in front of this slave (0: of the first), on its way out or back.
  struct Damage {
    std::size_t cable = 0;
    bool way_back = false;
  };

  std::set<std::uint64_t> lost_requests;  ///< Lost before the first slave.
  std::set<std::uint64_t> lost_answers;   ///< Lost behind the last: what they asked for was done.
  std::uint32_t loses_every = 0;          ///< Each frame whose number this divides loses its answer; 0: none.
  std::set<std::uint64_t> short_counters;  ///< Every working counter comes back with one less.
  std::uint32_t shortens_every = 0;        ///< As loses_every, for working counters.
  std::map<std::uint64_t, Damage> damaged;
  Duration delay{};  ///< From a frame to its return.
};

/// What happens to the wire at a time.
struct RingEvent {
  enum class Kind : std::uint8_t { cut_cable, join_cable, power_off, power_on };

  TimePoint time;
  Kind kind = Kind::cut_cable;
  std::size_t slave = 0;
};

/// The wire of an EtherCAT master: frames go through its slaves in their order and come back. Cables stand in
/// front of each slave, and can be cut. Performs no I/O and reads no clock.
class EscRing {
 public:
  /// The slave goes to the end of the ring and gets its power; it outlives the ring.
  void attach(EscSlave& slave, TimePoint now);
  std::size_t size() const { return slaves_.size(); }

  void on_frame(ByteSpan frame, TimePoint now);
  void on_time(TimePoint now);
  /// A frame that has come back.
  std::optional<Bytes> take_frame();
  TimePoint deadline() const;

  RingFaults& faults() { return faults_; }
  /// So many frames were sent.
  std::uint64_t sent() const { return sent_; }
  /// The cable in front of this slave; 0 is the master's.
  void cut_cable(std::size_t slave);
  void join_cable(std::size_t slave);
  /// Frames do not get past a slave without power.
  void power_off(std::size_t slave);
  void power_on(std::size_t slave, TimePoint now);
  /// Does one of the above at its time; events of one time in the order in which they were planned.
  void plan(RingEvent event);
  /// Slaves that frames of the master reach.
  std::size_t reachable() const;

 private:
  struct Place {
    EscSlave* slave = nullptr;
    bool powered = true;
    bool cut = false;
  };
  struct Returning {
    Bytes frame;
    TimePoint due;
  };

  bool pass(Bytes& frame, TimePoint now);
  bool is_damaged(std::size_t cable, bool way_back) const;
  bool comes_back() const;
  bool comes_back_short() const;
  static void shorten_counters(Bytes& frame);
  void carry_out(const RingEvent& event);
  bool joins(std::size_t cable) const;
  void update_links();

  std::vector<Place> slaves_;
  RingFaults faults_;
  std::uint64_t sent_ = 0;
  std::deque<Returning> returning_;
  std::multimap<TimePoint, RingEvent> planned_;
  TimePoint now_{};
};

}  // namespace servoctl::sim
