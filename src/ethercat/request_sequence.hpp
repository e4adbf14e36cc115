#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// Makes requests one after another, each when the one before is done: settings of a slave (SlavePlan,
/// SmWatchdog, mailbox_setup) and the like. Performs no I/O and reads no clock; a Carrier takes its requests.
/// The first that is not done ends it.
class RequestSequence {
 public:
  /// `node` 1..127 is for messages; 0: the requests concern all slaves.
  explicit RequestSequence(std::uint8_t node) : node_(node) {}

  void start(std::vector<Request> requests);
  std::optional<Request> take_request();
  void on_answer(const Answer& answer, TimePoint now);
  bool busy() const { return next_ < requests_.size(); }
  /// Set once: what each request brought back. Errc::timeout naming the register that was not reached.
  std::optional<Result<std::vector<Bytes>>> take_result();

 private:
  std::uint8_t node_;
  std::vector<Request> requests_;
  std::size_t next_ = 0;
  bool asking_ = false;
  std::vector<Bytes> answers_;
  std::optional<Result<std::vector<Bytes>>> result_;
};

/// The writes that put all slaves of a ring into their state after power on, in INIT: loops, error counters,
/// FMMUs, sync managers, distributed clocks, access to the SII. Takes a ring over: not for one that another
/// master works with. Some registers do not exist in every slave: what is not there takes no write, which is
/// no error.
std::vector<Request> default_settings();

/// The writes that give the slave at `position` (0: the first) its station address.
std::vector<Request> station_setup(std::uint16_t position, std::uint16_t station);

}  // namespace servoctl::ethercat
