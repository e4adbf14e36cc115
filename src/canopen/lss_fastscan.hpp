#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/result.hpp"
#include "base/time.hpp"
#include "canopen/lss_master.hpp"

namespace servoctl::canopen {

/// Finds one slave that has no node-ID, whatever its identity (CiA 305, LSS fastscan): bit by bit whoever
/// still fits is asked whether the bit is 0, and that nobody answers means 1. The slave that is found is in
/// the configuration state then, and answers no further scan. Performs no I/O and reads no clock.
///
/// A bit is taken from the first answer or from silence, so a frame that is lost or late makes a wrong one.
/// Each of the four numbers is therefore asked for as a whole at its end; where nobody has it, the scan
/// fails.
class LssFastscan {
 public:
  struct Options {
    Duration patience = std::chrono::milliseconds(50);  ///< For an answer to one step.
    Duration further = std::chrono::milliseconds(5);    ///< For another slave's, behind the first.
  };
  struct Found {
    LssAddress address;
    std::size_t slaves = 1;  ///< That said it was they, at the end: more than 1 have one identity.
  };
  /// Steps of a scan that finds a slave.
  static constexpr std::size_t kSteps = 1 + 4 * 33;

  explicit LssFastscan(Options options);

  void start(TimePoint now);
  void on_frame(const can::Frame& frame, TimePoint now) { master_.on_frame(frame, now); }
  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame() { return master_.take_frame(); }
  /// Set once: what was found; empty when nobody without a node-ID is there. Errc::protocol when slaves
  /// answered, and none of them to a whole number: one may be in the configuration state all the same, its
  /// answer lost. All are to be sent to waiting then, and the scan begun anew with more patience.
  std::optional<Result<std::optional<Found>>> take_result();
  TimePoint deadline() const { return master_.deadline(); }
  std::size_t steps() const { return steps_; }  ///< Done, of kSteps.

 private:
  void ask(TimePoint now);
  void on_begun(std::size_t answers, TimePoint now);
  void on_bit(std::size_t answers, TimePoint now);
  void on_number(std::size_t answers, TimePoint now);
  void begin_part(std::uint8_t part, TimePoint now);

  Options options_;
  LssMaster master_;
  LssFastscanStep step_;
  bool asked_twice_ = false;  ///< Whether anybody is there.
  bool whole_ = false;        ///< The number is asked for as a whole.
  std::array<std::uint32_t, 4> numbers_{};
  std::size_t steps_ = 0;
  std::optional<Result<std::optional<Found>>> result_;
};

}  // namespace servoctl::canopen
