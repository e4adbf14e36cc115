#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string_view>

#include "can/trace.hpp"

namespace servoctl::traffic {

/// What frames can be looked for, to see what was around them.
inline constexpr std::string_view kOccasions[] = {"emcy", "abort", "boot-up", "error"};

/// Hands frames on in their order: those that lie within `reach` of an occasion to `show`, all others to
/// `pass`. Keeps no more than those of one reach.
class FramesAround {
 public:
  using Take = std::function<void(const can::LogFrame& line)>;

  /// `occasion`: of kOccasions.
  FramesAround(std::string_view occasion, Duration reach, Take show, Take pass)
      : occasion_(occasion), reach_(reach), show_(std::move(show)), pass_(std::move(pass)) {}

  void add(const can::LogFrame& line);
  void end();
  std::size_t occasions() const { return occasions_; }

 private:
  bool is_occasion(const can::Frame& frame) const;

  std::string_view occasion_;
  Duration reach_;
  Take show_;
  Take pass_;
  std::deque<can::LogFrame> waiting_;  ///< Of which nobody knows yet.
  std::optional<Duration> last_;       ///< The last occasion.
  std::size_t occasions_ = 0;
};

}  // namespace servoctl::traffic
