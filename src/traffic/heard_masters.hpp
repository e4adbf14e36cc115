#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::traffic {

/// Which heartbeats end because their producer ends: a master that does takes itself out of the drives that
/// watch it (1016h) right before, as they confirm. No node that was heard as a drive is one.
class HeardMasters {
 public:
  void on_frame(const can::Frame& frame, TimePoint time);

  /// Whether each drive that was heard to consume the heartbeat of this node was told not to any more, at
  /// most three seconds before its end was noticed.
  bool has_left(std::uint8_t producer, TimePoint noticed) const;

 private:
  using Place = std::pair<std::uint8_t, std::uint8_t>;  ///< A node and a sub-index of 1016h.

  void on_confirmed(const Place& place, TimePoint time);

  std::map<Place, std::uint8_t> asked_;    ///< Whom it is to consume; 0: nobody. Not confirmed yet.
  std::map<Place, std::uint8_t> entries_;  ///< Whom it consumes.
  std::map<std::uint8_t, TimePoint> left_;
  std::set<std::uint8_t> drives_;
};

}  // namespace servoctl::traffic
