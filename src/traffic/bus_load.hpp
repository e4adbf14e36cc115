#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::traffic {

/// How busy a bus is, from the frames that pass. The load is known where the bitrate is.
class BusLoad {
 public:
  /// `bitrate` in bit/s; 0: not known.
  BusLoad(std::uint32_t bitrate, TimePoint begin) : bitrate_(bitrate), begin_(begin), window_begin_(begin) {}

  void add(const can::Frame& frame, TimePoint time);

  std::size_t frames() const { return frames_; }
  /// Per cent of the time in which the bus carried frames, from the beginning to `now`.
  std::optional<double> mean(TimePoint now) const { return load(bits_, now - begin_); }
  /// The busiest full tenth of a second; empty before the first is over.
  std::optional<double> peak() const { return peak_ == 0 ? std::nullopt : load(peak_, kWindow); }

 private:
  static constexpr Duration kWindow = std::chrono::milliseconds(100);

  std::optional<double> load(std::uint64_t bits, Duration time) const;

  std::uint32_t bitrate_;
  TimePoint begin_;
  std::size_t frames_ = 0;
  std::uint64_t bits_ = 0;
  TimePoint window_begin_;
  std::uint64_t window_bits_ = 0;
  std::uint64_t peak_ = 0;
};

}  // namespace servoctl::traffic
