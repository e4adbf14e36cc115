#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "can/log_clock.hpp"
#include "can/trace.hpp"
#include "show/sample_writer.hpp"
#include "traffic/frame_decoder.hpp"
#include "traffic/frame_table.hpp"

namespace servoctl::traffic {

/// Which frames are to be shown. Frames of the whole bus (NMT to all, SYNC, TIME) pass a filter of nodes.
struct FrameFilter {
  std::vector<std::uint8_t> nodes;         ///< Empty: all.
  std::vector<std::string_view> services;  ///< Of kServices; empty: all.
  std::vector<ObjectAddress> objects;      ///< Empty: all frames; else those that carry or name one of these.

  bool passes(const DecodedFrame& frame) const;
};

/// Shows frames with what they mean, one a line or a record, as far as they pass the filter.
class FrameLog {
 public:
  FrameLog(show::Desk& desk, FrameFilter filter, bool raw);

  /// `time` in a record is that of the log; in text it counts from the first frame.
  void add(Duration time, std::string_view interface_name, const can::Frame& frame);
  /// A frame that is not to be shown: what it teaches counts.
  void skip(const can::Frame& frame) { (void)decoder_.decode(frame); }
  /// Something that is no frame: an alarm.
  void remark(Duration time, std::string_view service, std::optional<std::uint8_t> node,
              std::string_view text, std::string_view event);
  void flush() { writer_.flush(); }
  /// From now on a table of FrameTable::layout() shows the frames, and alarms under it; `view` outlives the
  /// log.
  void show_in(show::LiveView& view) {
    view_ = &view;
    table_.emplace(view);
  }

  /// From now on the times are those of this clock, which outlives the log and may change from frame to
  /// frame.
  void show_clock(const can::LogClock& clock) { clock_ = &clock; }

  FrameDecoder& decoder() { return decoder_; }
  std::size_t count() const { return count_; }
  /// How many frames of each service came, shown or not.
  const std::map<std::string_view, std::size_t>& services() const { return services_; }
  report::Written take_kept() { return writer_.take_kept(); }

 private:
  void begin_line(Duration time);
  void add_node(std::optional<std::uint8_t> node);

  FrameFilter filter_;
  bool raw_;
  show::SampleWriter writer_;
  FrameDecoder decoder_;
  bool chinese_;
  std::size_t count_ = 0;
  std::map<std::string_view, std::size_t> services_;
  std::optional<Duration> begin_;
  const can::LogClock* clock_ = nullptr;
  std::string line_;
  show::LiveView* view_ = nullptr;
  std::optional<FrameTable> table_;
};

}  // namespace servoctl::traffic
