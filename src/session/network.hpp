#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "canopen/emergency.hpp"
#include "canopen/transfer.hpp"
#include "session/life_sign.hpp"
#include "session/node_event.hpp"
#include "session/node_state.hpp"

namespace servoctl::session {

class CanNetwork;
class EtherCatNetwork;
class GatewayNetwork;
class ModbusNetwork;
class Protection;

/// The way to the objects of one node: one transfer at a time, whatever carries it. Lives no longer than its
/// network, which serves it in every step: what the node answers is noted there.
///
/// Every transfer ends with exactly one result: the data, or Errc::sdo_abort (with the abort code), timeout
/// or protocol, with node and object set.
class ObjectChannel {
 public:
  ObjectChannel() = default;
  ObjectChannel(const ObjectChannel&) = delete;
  ObjectChannel& operator=(const ObjectChannel&) = delete;
  virtual ~ObjectChannel() = default;

  /// The longest silence of the node in a transfer. Not to be called while one is under way.
  virtual void set_timeout(Duration timeout) = 0;

  /// Reads an object. Not to be called while a transfer is under way. `size` is how many bytes the object
  /// has, if that is known and needed, else 0. Sends nothing yet: on_time() does.
  virtual void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                            std::size_t size) = 0;
  /// The next start_upload() is a further try of the read before it, which was not answered in time: a late
  /// answer to that one is an answer to it as well. Where this is not said, a late answer is none.
  virtual void try_again() {}
  /// Writes an object; else as start_upload().
  virtual void start_download(ObjectAddress object, Bytes data, TimePoint now,
                              canopen::Transfer transfer) = 0;

  /// Sends what is to be sent, and ends a transfer that has waited too long. To be called after each start
  /// and each step of the network, before take_result(). Errc::bus when the network does not take it.
  virtual Result<void> on_time(TimePoint now) = 0;

  /// Set once, when the transfer has ended; empty bytes after a write.
  virtual std::optional<Result<Bytes>> take_result() = 0;
  /// A transfer is under way. One that has ended and whose result was not taken is not.
  virtual bool busy() const = 0;
  /// When on_time() has something to do although nothing arrived; kNever while nothing is under way.
  virtual TimePoint deadline() const = 0;
  virtual std::size_t transferred()
      const = 0;  ///< Bytes of this transfer that the other side has, or that came.
  virtual std::optional<std::size_t> total() const = 0;  ///< Bytes of the whole transfer, when known.

  /// Whether anything was started or came in since the last on_time(): else there is nothing to do before the
  /// deadline. A channel that does not keep account says so always.
  bool stirred() const { return stirred_; }

 protected:
  bool stirred_ = true;
};

/// Values that one node sends unasked while this lives: from its TPDOs, or its part of a process
/// image.
class ProcessValues {
 public:
  ProcessValues() = default;
  ProcessValues(const ProcessValues&) = delete;
  ProcessValues& operator=(const ProcessValues&) = delete;
  virtual ~ProcessValues() = default;

  struct Arrival {
    ObjectAddress object;
    Bytes value;
    TimePoint
        time;  ///< When the frame that brought it arrived; on a ring when the one was sent that fetched it.
  };

  /// The value that came since `since`, each one once; empty when none has: the object is to be read then.
  virtual std::optional<Bytes> take(ObjectAddress object, TimePoint since) = 0;
  /// Whether the node sends the object, or a part of it, by itself now.
  virtual bool carries(ObjectAddress object) const = 0;
  /// From now on every value is kept until take_all(), in every wait.
  virtual void keep_all() = 0;
  /// What came since the last call, in order of time; nothing before keep_all().
  virtual std::vector<Arrival> take_all() = 0;
};

/// What was heard of each node (1..127) in all waits since the network was opened.
class NodeRecords {
 public:
  virtual ~NodeRecords() = default;

  /// The state heard last; empty until one was heard.
  virtual std::optional<NodeState> state(std::uint8_t node) const = 0;
  /// How often it was heard to start.
  virtual std::uint32_t boots(std::uint8_t node) const = 0;
  /// How often it reported its state otherwise: heartbeats and guarding responses.
  virtual std::uint32_t heartbeats(std::uint8_t node) const = 0;
  /// The last emergencies since its start or error reset, oldest first, at most eight.
  virtual const std::deque<canopen::Emergency>& emergencies(std::uint8_t node) const = 0;
  /// How many emergencies it has sent that were no error reset.
  virtual std::uint32_t alarms(std::uint8_t node) const = 0;
};

/// One wire with its nodes, and the clock that belongs to it. Everything above knows nodes by their number
/// (1..127), objects and states; frames, COB-IDs and NMT bytes are known below, and to what asks for can().
class Network {
 public:
  Network() = default;
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  virtual ~Network() = default;

  virtual TimePoint now() const = 0;

  /// Waits until `deadline` at most, and takes in one arrival at most: whoever it concerns is served, the
  /// channels, the records, what servoctl sends regularly. True when something arrived; without it a step may
  /// end before the deadline. Errc::bus when the network is lost: nothing will be answered then.
  virtual Result<bool> step(TimePoint deadline) = 0;
  /// When what the last step took in arrived, or when it ended without; asks no clock.
  virtual TimePoint stepped_at() const = 0;
  /// When step() has something to do although nothing arrives from outside; kNever when it has not.
  virtual TimePoint next_event() const = 0;
  /// While something else is waited for and nothing can be taken in: sends what is sent regularly and is due.
  /// When it is to be called again; what is not later than now() is for step() alone.
  virtual TimePoint keep_up() { return must_go_on() ? now() : kNever; }
  /// A descriptor that becomes readable when step() has something to take in, for a poll loop; -1: none.
  virtual int poll_fd() const { return -1; }
  /// After Errc::bus: waits until `deadline` at most for the network to come back. Errc::bus while it is not
  /// back; at once where it never comes.
  virtual Result<void> recover(TimePoint deadline) = 0;

  /// Asked in waits that are the network's own: when it answers true they end with Errc::interrupted.
  virtual void set_cancelled(std::function<bool()>) {}
  /// Held (Care::unsettled) while a node is in a state that ends with this program only. May be null;
  /// outlives the network.
  virtual void set_protection(Protection*) {}

  virtual std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) = 0;

  virtual const NodeRecords& records() const = 0;
  /// What nodes sent since the last call, in order of time; empty if nothing is left.
  virtual std::optional<NodeEvent> take_event() = 0;

  /// Commands a state change of the node; whether something confirms it is the network's own. Errc::usage for
  /// a state that this network has no word for, Errc::bus when it is not sent.
  virtual Result<void> request_state(std::uint8_t node, NodeState state) = 0;
  /// Who is told of every command for the state of a node that has gone out, in the words of state_order();
  /// node 0: every node. May be empty.
  void set_ordered(std::function<void(std::uint8_t node, std::string_view order)> told) {
    ordered_ = std::move(told);
  }
  /// Asks the node for its state where that is a question of its own; the answer goes to records().
  virtual Result<void> ask_state(std::uint8_t node) = 0;
  /// The node is told to change its state: what was heard of it is no longer known to be so, unless it goes
  /// on telling it by itself.
  virtual void doubt_state(std::uint8_t node) = 0;
  /// Every node answers the question for its state, and nothing comes of asking.
  virtual bool tells_state() const { return false; }
  /// Nodes depend on what servoctl sends regularly now: step() must be called at next_event() whoever is
  /// waited for.
  virtual bool must_go_on() const { return false; }
  /// Where a drive stays energised only while servoctl exchanges process data with it: that ends, and the
  /// node goes back to where only its objects are served. Nothing anywhere else.
  virtual Result<void> end_exchange(std::uint8_t) { return {}; }
  /// The user has the node in OP (`state op`), whatever is done with its power meanwhile.
  virtual bool stays_operational(std::uint8_t) const { return false; }

  /// Whether it has this sign for its nodes.
  virtual bool carries(LifeSign::Kind sign) const = 0;
  /// From now on tells the node in every step that servoctl lives; the first time at once. What it does
  /// without that is written to its objects, by the caller. Errc::usage for a sign that this network does not
  /// have.
  virtual Result<void> arm_watchdog(std::uint8_t node, const LifeSign& sign) = 0;
  /// Ends the life sign.
  virtual void disarm_watchdog(std::uint8_t node) = 0;
  /// Sends the write of an object of two bytes and looks no further: for a way out on which nothing else
  /// works any more. Needs no memory.
  virtual void send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept = 0;

  /// What the node tells of these objects by itself, as far as its mapping is known; see process_values().
  virtual std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                        std::span<const ObjectAddress> objects) = 0;

  /// What people should know of the network beside its nodes, a line each, since the last call.
  virtual std::vector<Message> take_notices() { return {}; }
  /// Whatever is kept back for a file is written to it now.
  virtual void flush_trace() {}

  /// What the states of its nodes are called: `NMT state`, `AL state`.
  virtual std::string_view state_title() const { return "state"; }
  /// Its own word for a state: `pre-operational`, `PRE-OP`.
  virtual std::string_view state_word(NodeState state) const { return name(state); }
  /// What request_state() sends, in words that follow "it was sent": `NMT "stop"`, `the request for PRE-OP`.
  virtual std::string state_order(NodeState state) const;
  /// Its nodes are asked one after the other, so that each that is silent costs a timeout of its own.
  virtual bool takes_turns() const { return false; }
  /// A node is a place on a ring, not a number of its own.
  virtual bool is_ring() const { return false; }
  /// Why no drive may be energised over it; empty: it may.
  virtual std::string_view why_no_power() const { return {}; }
  /// What to do about a node that does not answer.
  virtual std::string silence_hint(std::uint8_t node) const;
  /// The command that asks for a state of the node: `nmt start -n 3`.
  virtual std::string state_command(std::uint8_t node, NodeState state) const;

  /// What only CAN has; null where there are no COB-IDs.
  virtual CanNetwork* can() { return nullptr; }
  /// What only EtherCAT has; null elsewhere.
  virtual EtherCatNetwork* ethercat() { return nullptr; }
  /// What only Modbus has; null elsewhere.
  virtual ModbusNetwork* modbus() { return nullptr; }
  /// What only a gateway of CiA 309-3 has; null elsewhere.
  virtual GatewayNetwork* gateway() { return nullptr; }

  /// Ends what servoctl keeps up on it, and its trace. The last call, while everybody who is told of orders,
  /// notices or the trace is still there: a destructor sends nothing and tells nobody. Does not hear the
  /// question whether it is cancelled. An error of the first node that could not be put back; all are tried.
  virtual Result<void> close() { return {}; }

  /// What energises the node later was sent, such as a PDO that waits for SYNC: that it is seen at rest
  /// proves nothing until it was seen energised, or was disabled. Nothing where every write is answered.
  virtual void expect_power(std::uint8_t) {}
  virtual void end_expecting(std::uint8_t) {}
  virtual bool expects_power(std::uint8_t) const { return false; }

 protected:
  std::function<void(std::uint8_t node, std::string_view order)> ordered_;
};

}  // namespace servoctl::session
