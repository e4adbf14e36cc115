#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "ethercat/frame.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// The datagrams under way on one wire: packs what is to be sent into frames, and gives each answer to whom
/// it belongs. Performs no I/O and reads no clock. Answers are known by index, command, length and address,
/// not by MAC address: the first slave changes it (ETG.1000.4, 5.3.4), emulated ones do not. Frames that this
/// machine has sent itself must not be given to it: the port knows them.
class Ring {
 public:
  struct Options {
    MacAddress source{0x02, 0x00, 0x00, 0x00, 0x00, 0x01};  ///< Locally administered.
    Duration timeout = std::chrono::milliseconds(20);       ///< Until a frame counts as lost.
    unsigned repeats = 2;  ///< Of what is repeatable: lost, or for one slave and not counted by it.
    std::size_t frames_in_flight = 4;  ///< More wait; what is urgent does not. At most kMaxFlights.
  };
  struct Statistics {
    std::uint64_t sent = 0;            ///< Frames.
    std::uint64_t received = 0;        ///< Frames with an answer to something.
    std::uint64_t lost = 0;            ///< Frames that did not come back in time.
    std::uint64_t repeated = 0;        ///< Datagrams.
    std::uint64_t late = 0;            ///< Datagrams that came back when nobody waited for them.
    std::uint64_t damaged = 0;         ///< Frames of EtherCAT whose lengths do not fit.
    std::uint64_t short_counters = 0;  ///< Datagrams whose counter was below what was expected.
  };
  struct Post {
    bool repeatable = false;
    bool urgent = false;            ///< Goes before all others, and with as many frames as it takes.
    std::uint16_t expected = 0;     ///< Working counter; less is counted.
    Duration timeout = Duration{};  ///< 0: that of the ring.
  };
  using Ticket = std::uint32_t;
  static constexpr std::size_t kMaxFlights = 64;

  explicit Ring(const Options& options);

  /// Takes a datagram to be sent. Empty when 256 of them are under way or not taken back: try again later.
  /// `data` has at most kMaxDatagramData bytes.
  std::optional<Ticket> post(Command command, std::uint32_t address, ByteSpan data, const Post& how);
  std::optional<Ticket> post(const Request& request);
  /// What became of it, once; empty while it is under way.
  std::optional<Answer> take_answer(Ticket ticket);
  /// Nobody asks for the answer any more.
  void forget(Ticket ticket);

  /// The next frame to send, if any: a view that is valid until the next call.
  std::optional<ByteSpan> take_frame(TimePoint now);
  /// A frame came in. True when it had an answer for somebody; others are none of the ring's.
  bool on_frame(ByteSpan frame, TimePoint now);
  void on_time(TimePoint now);
  /// When on_time() has something to do; kNever while nothing is under way.
  TimePoint deadline() const;

  const Statistics& statistics() const { return statistics_; }

 private:
  enum class State : std::uint8_t { free, queued, in_flight, answered };
  struct Slot {  ///< Its number is the index of the datagram.
    State state = State::free;
    bool abandoned = false;
    std::uint8_t flight = 0;
    std::uint32_t generation = 0;
    Command command = Command::nop;
    std::uint32_t address = 0;
    Bytes data;
    Post how;
    unsigned repeats = 0;
    Answer answer;
  };
  struct Flight {  ///< A frame under way.
    std::size_t open = 0;
    TimePoint deadline = kNever;
  };

  Slot* slot_of(Ticket ticket);
  std::optional<std::uint8_t> free_slot();
  std::optional<std::uint8_t> free_flight() const;
  bool may_send() const;
  void enqueue(std::uint8_t index);
  void pack(FrameWriter& writer, std::vector<std::uint8_t>& queue, std::uint8_t flight, TimePoint now);
  Slot* match(const Datagram& datagram);
  static bool is_tried_again(const Slot& slot, const Datagram& datagram);
  void take_in(Slot& slot, const Datagram& datagram);
  void lose(std::uint8_t index);
  void land(Slot& slot);

  Options options_;
  std::array<Slot, 256> slots_;
  std::array<Flight, kMaxFlights> flights_;
  std::size_t flying_ = 0;
  std::vector<std::uint8_t> urgent_;
  std::vector<std::uint8_t> waiting_;
  std::uint8_t next_ =
      0;  ///< Where the search for a free slot begins: an index rests before it is used again.
  std::array<std::uint8_t, kMaxFrame> buffer_{};
  Statistics statistics_;
};

/// Carries the requests of one machine over a ring, one at a time, and their answers back. A machine has
/// `take_request()` and `on_answer(const Answer&, TimePoint)`.
class Carrier {
 public:
  /// To be called whenever the machine may have something to ask, and after each frame and each on_time() of
  /// the ring, again while it is true: there was something to do.
  template <class Machine>
  bool serve(Machine& machine, Ring& ring, TimePoint now) {
    if (ticket_) {
      const auto answer = ring.take_answer(*ticket_);
      if (!answer) return false;
      ticket_.reset();
      machine.on_answer(*answer, now);
      return true;  // What came of it may change what the machine asks next.
    }
    if (!request_) request_ = machine.take_request();
    if (!request_) return false;
    ticket_ = ring.post(*request_);
    if (ticket_) request_.reset();
    return ticket_.has_value();
  }
  /// The machine is about to go: what comes back is nobody's.
  void leave(Ring& ring);

 private:
  std::optional<Ring::Ticket> ticket_;
  std::optional<Request> request_;
};

}  // namespace servoctl::ethercat
