#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "base/time.hpp"
#include "ethercat/coe_client.hpp"
#include "ethercat/coe_info.hpp"
#include "ethercat/mailbox.hpp"
#include "ethercat/ring.hpp"

namespace servoctl::ethercat {

/// CANopen over EtherCAT of one slave: its mailbox on a ring, and who speaks through it. A transfer and a
/// question for the dictionary may go on side by side.
class CoeSlave {
 public:
  /// `node` 1..127 is for messages; `timeout` is the longest silence of the slave.
  CoeSlave(std::uint8_t node, SlaveAddress slave, const Mailbox::Options& options, Duration timeout)
      : mailbox_(node, slave, options),
        client_(node, timeout, mailbox_.max_message()),
        info_(node, timeout) {}

  Mailbox& mailbox() { return mailbox_; }
  CoeClient& client() { return client_; }
  CoeInfo& info() { return info_; }

  /// Moves everything between the ring and the machines as far as it goes. To be called after each start of a
  /// transfer, each frame of the ring and each of its on_time().
  void serve(Ring& ring, TimePoint now);
  /// Ends what has waited too long; serve() is to follow.
  void on_time(TimePoint now);
  /// When on_time() has something to do although nothing arrived; the ring has its own.
  TimePoint deadline() const { return std::min({mailbox_.deadline(), client_.deadline(), info_.deadline()}); }
  /// The slave is about to go: what comes back is nobody's.
  void leave(Ring& ring) { carrier_.leave(ring); }

 private:
  void take_events(TimePoint now);
  void hand_over(TimePoint now);
  void drop_what_is_over();

  Mailbox mailbox_;
  CoeClient client_;
  CoeInfo info_;
  Carrier carrier_;
  enum class Owner : std::uint8_t { nobody, client, info };
  Owner owner_ = Owner::nobody;  ///< Whose request was handed over last, while it is under way.
};

}  // namespace servoctl::ethercat
