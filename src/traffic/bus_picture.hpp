#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "can/bus.hpp"
#include "can/controller_report.hpp"
#include "can/error_frame.hpp"
#include "canopen/duplicate_watch.hpp"
#include "traffic/bus_load.hpp"

namespace servoctl::traffic {

/// What was heard of a CAN bus in a while: frames, errors on the wire, reports of the controller.
class BusPicture {
 public:
  /// `bitrate` in bit/s; 0: not known.
  BusPicture(std::uint32_t bitrate, TimePoint begin) : load_(bitrate, begin), begin_(begin) {}

  void add(const can::Frame& frame, TimePoint time);
  /// The listening is over.
  void end(TimePoint time) { end_ = time; }

  Duration length() const { return end_ - begin_; }
  std::size_t frames() const { return frames_; }
  std::size_t extended() const { return extended_; }  ///< Of them with a 29-bit identifier: not of CANopen.
  const std::set<std::uint8_t>& nodes() const { return nodes_; }  ///< That told that they live.

  std::size_t errors(can::WireError error) const { return errors_.count(error); }
  std::size_t damage() const { return errors_.damage(); }
  std::size_t unacknowledged() const { return errors(can::WireError::acknowledge); }
  std::size_t while_sending() const { return while_sending_; }
  const std::string& wires() const { return wires_; }  ///< What the transceiver said of them; empty: nothing.
  std::string damage_text() const { return errors_.text(); }

  std::size_t reports(can::ControllerReport report) const {
    return reports_[static_cast<std::size_t>(report)];
  }
  std::optional<double> load() const { return load_.mean(end_); }
  std::optional<double> peak_load() const { return load_.peak(); }
  const canopen::DuplicateWatch& duplicates() const { return duplicates_; }

 private:
  BusLoad load_;
  TimePoint begin_;
  TimePoint end_ = begin_;
  std::size_t frames_ = 0;
  std::size_t extended_ = 0;
  std::size_t while_sending_ = 0;
  can::WireErrors errors_;
  std::array<std::size_t, 7> reports_{};
  std::set<std::uint8_t> nodes_;
  std::string wires_;
  canopen::DuplicateWatch duplicates_;
};

}  // namespace servoctl::traffic
