#pragma once

#include <cstdint>
#include <map>

#include "base/rhythm.hpp"
#include "show/live_view.hpp"
#include "traffic/frame_decoder.hpp"

namespace servoctl::traffic {

/// The frames of a bus, one row for each CAN-ID: how often it came, and what the last one means.
class FrameTable {
 public:
  static show::LiveView::Layout layout();

  /// `view` has layout(), and outlives the table.
  explicit FrameTable(show::LiveView& view) : view_(&view) {}

  /// `time`: of the log.
  void add(Duration time, const can::Frame& frame, const DecodedFrame& decoded);

 private:
  show::LiveView* view_;
  std::map<std::uint32_t, Rhythm> rhythms_;  ///< By canopen::can_id_of().
};

}  // namespace servoctl::traffic
