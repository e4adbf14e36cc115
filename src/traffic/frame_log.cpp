#include "traffic/frame_log.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "report/catalogue.hpp"

namespace servoctl::traffic {
namespace {

/// Columns of the frame itself in a line: `601#4041600000000000`.
constexpr std::size_t kFrameWidth = 21;
/// Columns of the seconds before the point.
constexpr std::size_t kSecondsWidth = 4;

double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

void write_service(std::string_view service, std::optional<std::uint8_t> node, report::JsonWriter& json) {
  json.member("service", service);
  json.key("node");
  node ? json.value(*node) : json.null();
}

/// Right-aligned in `width` columns.
void append_number(std::int64_t number, std::size_t width, char fill, std::string& out) {
  const fmt::format_int digits(number);
  if (digits.size() < width) out.append(width - digits.size(), fill);
  out.append(digits.data(), digits.size());
}

}  // namespace

bool FrameFilter::passes(const DecodedFrame& frame) const {
  const auto has = [](const auto& list, const auto& value) {
    return std::find(list.begin(), list.end(), value) != list.end();
  };
  if (!nodes.empty() && frame.node && !has(nodes, *frame.node)) return false;
  if (!services.empty() && !has(services, frame.service)) return false;
  return objects.empty() || std::any_of(frame.objects.begin(), frame.objects.end(),
                                        [&](ObjectAddress object) { return has(objects, object); });
}

FrameLog::FrameLog(show::Desk& desk, FrameFilter filter, bool raw)
    : filter_(std::move(filter)),
      raw_(raw),
      writer_(desk),
      decoder_({desk.profile, desk.standard, desk.chinese, writer_.wants_records()}),
      chinese_(desk.chinese) {}

void FrameLog::begin_line(Duration time) {
  const auto since = (time - begin_.value_or(time)).count();
  line_.clear();
  if (clock_ != nullptr) {
    (line_ += can::clock_text(*clock_, time, ' ')) += ' ';
    return;
  }
  // Logs that were put together may go back behind their first line.
  const auto size = since < 0 ? -since : since;
  if (since < 0)
    line_ += pad_left(formatted("-{}", size / 1'000'000), kSecondsWidth);
  else
    append_number(size / 1'000'000, kSecondsWidth, ' ', line_);
  line_ += '.';
  append_number(size % 1'000'000, 6, '0', line_);
  line_ += ' ';
}

void FrameLog::add_node(std::optional<std::uint8_t> node) {
  if (node)
    append_number(*node, 3, ' ', line_);
  else
    line_ += "  -";
  line_ += ' ';
}

void FrameLog::add(Duration time, std::string_view interface_name, const can::Frame& frame) {
  ++count_;
  if (!begin_) begin_ = time;
  const auto& decoded = decoder_.decode(frame);
  ++services_[decoded.service];
  if (!filter_.passes(decoded)) return;
  if (table_) return table_->add(time, frame, decoded);
  if (writer_.wants_records()) {
    return writer_.add_record([&](report::JsonWriter& json) {
      json.member("time", seconds(time));
      if (clock_ != nullptr) json.member("clock", can::clock_text(*clock_, time, 'T'));
      json.member("interface", interface_name);
      line_.clear();
      can::append(frame, line_);
      json.member("frame", line_);
      write_service(decoded.service, decoded.node, json);
      json.written(decoded.fields);
      json.member("text", decoded.text);
    });
  }
  begin_line(time);
  if (raw_) (line_ += pad_right(can::to_string(frame), kFrameWidth)) += ' ';
  add_node(decoded.node);
  line_ += decoded.text;
  writer_.add_line(line_);
}

void FrameLog::remark(Duration time, std::string_view service, std::optional<std::uint8_t> node,
                      std::string_view text, std::string_view event) {
  if (!filter_.services.empty() && service != "alarm") return;
  if (view_ != nullptr)
    return view_->remark(node ? formatted("{:.3f} s, node {}: {}", seconds(time), *node, text)
                              : formatted("{:.3f} s: {}", seconds(time), text));
  if (writer_.wants_records()) {
    return writer_.add_record([&](report::JsonWriter& json) {
      json.member("time", seconds(time));
      write_service(service, node, json);
      json.member("event", event);
      json.member("text", text);
    });
  }
  begin_line(time);
  if (raw_) line_.append(kFrameWidth + 1, ' ');
  add_node(node);
  line_ += chinese_ ? report::in_chinese(text) : std::string(text);
  writer_.add_line(line_);
}

}  // namespace servoctl::traffic
