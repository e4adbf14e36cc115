#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/ring.hpp"
#include "ethercat/slave_plan.hpp"

namespace servoctl::ethercat {

/// The process data of the slaves of one ring: outputs as they are set by object, inputs as they came,
/// exchanged once a cycle. Each slave has datagrams of its own, so that each is known to be there or not.
/// Performs no I/O and reads no clock.
///
/// Nothing flows until every output was set: a zero that nobody meant must not move, stop or starve a motor.
class ProcessImage {
 public:
  struct Options {
    Duration cycle = std::chrono::milliseconds(4);
    unsigned patience = 4;      ///< Cycles until a frame counts as lost; at most kMaxPatience.
    std::uint32_t logical = 0;  ///< The first logical address: images on one ring must not overlap.
  };
  static constexpr unsigned kMaxPatience = 6;

  /// What was counted of one slave since the cycles began.
  struct Counts {
    std::uint64_t cycles = 0;
    std::uint64_t lost = 0;           ///< Frames that did not come back.
    std::uint64_t short_outputs = 0;  ///< Frames whose outputs it did not take.
    std::uint64_t short_inputs = 0;   ///< Frames whose inputs it did not give.
    unsigned missing = 0;             ///< Cycles in succession that were not whole.
    std::uint16_t counter = 0;        ///< Working counter of the last cycle that was not whole.
    std::uint16_t expected = 0;       ///< What it should have been; 0: its frame did not come back.
  };
  /// What was counted of the cycles.
  struct Rhythm {
    std::uint64_t cycles = 0;
    std::uint64_t skipped = 0;  ///< Cycles that were due and not made: the program was late by more than one.
    Duration latest{};          ///< The most that a cycle began late.
  };
  struct Input {
    Bytes value;
    TimePoint time;  ///< When the frame was sent that fetched it: it is not older.
  };
  /// Names the first cycle that carries a value; see is_written().
  using Cycle = std::uint64_t;

  explicit ProcessImage(const Options& options);

  /// Takes a slave in, before the cycles begin: the logical address that its plan_slave() is to get. `lrw`:
  /// its FMMUs know it; else it is read and written apart. `node` 1..127, each once.
  std::uint32_t add(std::uint8_t node, const ProcessMapping& mapping, bool lrw = true);

  /// Bits of a mapped output or input; empty when the object is none.
  std::optional<std::size_t> output_bits(std::uint8_t node, ObjectAddress object) const;
  std::optional<std::size_t> input_bits(std::uint8_t node, ObjectAddress object) const;

  /// Sets a mapped output, wherever it is mapped: goes with the next cycle. `value` has as many bytes as its
  /// bits take. Errc::usage when the object is no output, or is of another length.
  Result<Cycle> set(std::uint8_t node, ObjectAddress object, ByteSpan value);
  /// As it was set; empty when it was not, or is no output.
  std::optional<Bytes> output(std::uint8_t node, ObjectAddress object) const;
  /// Whether the slave has taken a cycle that carried what was set, and has confirmed it by the exact working
  /// counter: of a cycle with any other counter nothing is believed.
  bool is_written(std::uint8_t node, Cycle cycle) const;
  /// What it gave last; empty when it is no input, or nothing came yet.
  std::optional<Input> input(std::uint8_t node, ObjectAddress object) const;
  /// The same, if it is not older than so many cycles.
  std::optional<Input> fresh_input(std::uint8_t node, ObjectAddress object, TimePoint now,
                                   unsigned cycles = 2) const;

  /// Outputs of the slave that nobody has set.
  std::vector<ObjectAddress> unset(std::uint8_t node) const;
  /// The cycles begin, the first at once. Errc::refused when an output was never set.
  Result<void> start(TimePoint now);
  void stop() { next_ = kNever; }
  bool running() const { return next_ != kNever; }
  /// The next cycle, and all that follow, come so much later; earlier when it is negative.
  void shift(Duration by) {
    if (running()) next_ += by;
  }

  /// Takes in what came, and sends a cycle that is due. To be called after each frame and each on_time() of
  /// the ring, and at deadline().
  void serve(Ring& ring, TimePoint now);
  /// The image is about to go: what comes back is nobody's.
  void leave(Ring& ring);
  /// When the next cycle is due; kNever while none is.
  TimePoint deadline() const { return next_; }

  /// Of a node that was added.
  const Counts& counts(std::uint8_t node) const;
  const Rhythm& rhythm() const { return rhythm_; }
  const Options& options() const { return options_; }

 private:
  struct Field {
    ObjectAddress object;
    std::size_t at = 0;  ///< Bit in the outputs or inputs.
    std::size_t bits = 0;
    bool is_set = false;  ///< Of an output.
  };
  struct Flight {
    Ring::Ticket ticket = 0;
    Cycle cycle = 0;
    Command command = Command::nop;
    bool open = false;
  };
  struct Slave {
    std::uint8_t node = 0;
    bool lrw = true;
    std::uint32_t logical = 0;
    std::vector<Field> out_fields;
    std::vector<Field> in_fields;
    Bytes outputs;
    Bytes inputs;
    Cycle taken = 0;  ///< The last cycle whose outputs it took.
    Cycle given = 0;  ///< The last cycle whose inputs it gave.
    TimePoint given_at;
    Counts counts;
    std::array<Flight, 2 * kMaxPatience + 4> flights;
  };

  const Slave* find(std::uint8_t node) const;
  Slave* find(std::uint8_t node);
  void send(Slave& slave, Ring& ring);
  void post(Slave& slave, Command command, std::uint32_t logical, ByteSpan data, Ring& ring);
  void collect(Slave& slave, Ring& ring);
  void take_in(Slave& slave, const Flight& flight, const Answer& answer);
  void count(Slave& slave, const Flight& flight, bool whole);

  Options options_;
  std::vector<Slave> slaves_;
  std::uint32_t end_ = 0;  ///< The first logical address that is free.
  Cycle cycle_ = 0;        ///< The last one that was sent.
  TimePoint next_ = kNever;
  Bytes buffer_;
  Rhythm rhythm_;
};

}  // namespace servoctl::ethercat
