#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "sim/esc_faults.hpp"
#include "sim/esc_sync_manager.hpp"

namespace servoctl::sim {

/// What a mailbox protocol does with a request.
class EscProtocol {
 public:
  EscProtocol() = default;
  EscProtocol(const EscProtocol&) = delete;
  EscProtocol& operator=(const EscProtocol&) = delete;
  virtual ~EscProtocol() = default;

  struct Answer {
    std::vector<Bytes> messages = {};
    std::uint16_t error = 0;  ///< Of the mailbox (ETG.1000.4, table 30), instead of messages.
  };
  /// `most` bytes can be in each message.
  virtual Answer on_request(ByteSpan request, std::size_t most) = 0;
};

/// The mailboxes of a slave: what the master writes into the first goes to CoE, what CoE has to say waits
/// until the second is empty (ETG.1000.4, clause 5.6 and 6.7.4). Each message of the slave has the next
/// counter of 1 to 7; one of the master that has the counter of the last is that one again, and is dropped.
/// Reads no clock.
class EscMailbox {
 public:
  /// All outlive the mailbox.
  EscMailbox(EscSyncManager& out, EscSyncManager& in, EscProtocol& coe, EscFaults& faults)
      : out_(&out), in_(&in), coe_(&coe), faults_(&faults) {}

  /// PRE-OP begins.
  void start();
  void stop();
  /// After each frame, and when time goes on.
  void on_time(TimePoint now);
  TimePoint deadline() const;
  /// What CoE has to say by itself.
  void push(Bytes message, TimePoint now);

 private:
  struct Message {
    std::uint8_t type = 0;
    Bytes data;
    TimePoint due;
  };

  void on_message(ByteSpan message, TimePoint now);
  void on_repeat();
  void answer(std::uint8_t type, Bytes data, TimePoint now);
  void answer_error(std::uint16_t detail, TimePoint now);
  void fill(TimePoint now);

  EscSyncManager* out_;
  EscSyncManager* in_;
  EscProtocol* coe_;
  EscFaults* faults_;
  bool runs_ = false;
  std::uint8_t last_request_ = 0;  ///< Counter of the last message of the master.
  std::uint8_t counter_ = 0;       ///< Of the last of the slave.
  std::deque<Message> waiting_;
  std::deque<Bytes> returned_;  ///< Whole messages that a repeat has pushed out of the mailbox.
  Bytes present_;               ///< The message in the mailbox.
  Bytes last_read_;             ///< … that the master has read last.
};

}  // namespace servoctl::sim
