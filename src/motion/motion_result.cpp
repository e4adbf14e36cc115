#include "motion/motion_result.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "drive/cia402.hpp"
#include "report/catalogue.hpp"
#include "show/notice.hpp"

namespace servoctl::motion {
namespace {

using report::Record;
using report::Show;
using report::Value;

double seconds_since(const MotionSample& sample, TimePoint begin) {
  return std::chrono::duration<double>(sample.time - begin).count();
}

/// Six digits are more than any sensor has, and fewer than the noise of the conversion; counts stay whole.
double rounded(double value, int digits = 6) {
  return parse_real(plain_number(value, digits)).value_or(value);
}

/// As sentences have it.
double shown(double value) { return parse_real(number_text(value)).value_or(value); }

/// First, last, least and greatest value of one quantity; in JSON with six digits.
Value summary_of(const std::vector<Series>& series) {
  report::Table table;
  table.columns = {{"quantity"}, {"unit"}, {"first"}, {"last"}, {"least"}, {"greatest"}};
  for (const auto& one : series) {
    const auto [least, greatest] = std::minmax_element(one.values.begin(), one.values.end());
    table.rows.push_back({one.name, report::text_or_null(one.unit), shown(one.values.front()),
                          shown(one.values.back()), shown(*least), shown(*greatest)});
    table.documents.emplace_back(report::Record{{"quantity", one.name},
                                                {"unit", report::text_or_null(one.unit)},
                                                {"first", rounded(one.values.front())},
                                                {"last", rounded(one.values.back())},
                                                {"least", rounded(*least)},
                                                {"greatest", rounded(*greatest)}});
  }
  return table;
}

report::Plot samples_of(std::vector<Series> series) {
  for (auto& one : series)
    for (auto& value : one.values) value = rounded(value, 9);
  return {std::move(series)};
}

Value end_record(const MotionEnd& end) {
  report::List left(end.left.begin(), end.left.end());
  return Record{{"verified", end.verified},
                {"state", drive::name(end.state)},
                {"statusword", report::Hex{end.statusword, 4}},
                {"stopped", end.stopped},
                {"quick_stop", end.quick_stop},
                {"not_put_back", std::move(left)}};
}

/// What must be understood in every language, whatever becomes of its parts: whole sentences, of the state,
/// the statusword, what is expected of the motor, and what ended the motion.
struct Unverified {
  std::string_view alone;
  std::string_view because;
};
constexpr Unverified kNotSeen{
    "THE FINAL STATE COULD NOT BE VERIFIED: SWITCH OFF THE SUPPLY ({2})",
    "node {4}: THE FINAL STATE COULD NOT BE VERIFIED: SWITCH OFF THE SUPPLY ({2}); the motion ended with: {3}"};
constexpr Unverified kNotOff{
    "IT IS IN {0} (statusword 0x{1:04X}), NOT DE-ENERGISED: SWITCH OFF THE SUPPLY ({2})",
    "node {4}: IT IS IN {0} (statusword 0x{1:04X}), NOT DE-ENERGISED: SWITCH OFF THE SUPPLY ({2}); the motion "
    "ended with: {3}"};

Message unverified_text(const MotionEnd& end, const WatchdogPlan& watchdog, const Message& cause = {},
                        std::uint8_t node = 0) {
  const auto& words = end.statusword == 0 ? kNotSeen : kNotOff;
  return message(fmt::runtime(cause.empty() ? words.alone : words.because), drive::name(end.state),
                 end.statusword, expectation(watchdog, end.watched), cause, node_name(node));
}

/// A drive that may still be energised is worse than whatever ended the motion.
Error unverified(std::uint8_t node, const MotionReport& done) {
  const Message hint = "do not approach the machine before its supply is off";
  if (done.outcome) return drive_error(Errc::negative, node, unverified_text(done.end, done.watchdog), hint);
  const auto& cause = done.outcome.error();
  // One that is merely interrupted leaves nothing energised.
  const auto code = cause.code == Errc::interrupted ? Errc::negative : cause.code;
  auto error = make_error(code, unverified_text(done.end, done.watchdog, cause.message, node), hint);
  error.node = node;
  return error;
}

std::string_view result_text(const MotionReport& done) {
  if (!done.outcome) return "stopped";
  return done.differences.empty() ? "done" : "done, but";
}

Message end_words(const MotionEnd& end, const WatchdogPlan& watchdog) {
  if (end.verified)
    return message("{}{}, verified (statusword 0x{:04X})", drive::name(end.state),
                   end.quick_stop ? Message(" after a quick stop") : Message(), end.statusword);
  return unverified_text(end, watchdog);
}

Error ended(std::uint8_t node, const MotionReport& done) {
  auto error = done.outcome.error();
  error.message += message("; the drive is in {}", end_words(done.end, done.watchdog));
  if (!error.node) error.node = node;
  return error;
}

}  // namespace

std::string end_text(const MotionEnd& end, const WatchdogPlan& watchdog) {
  return end_words(end, watchdog).text();
}

Value motion_result(show::Desk& desk, std::uint8_t node, const MotionPlan& plan,
                    const std::vector<PreflightItem>& items, const MotionReport& done, bool plot) {
  const auto end = end_text(done.end, done.watchdog);
  if (!done.end.verified)
    desk.errors.push_back(unverified(node, done));
  else if (!done.outcome)
    desk.errors.push_back(ended(node, done));
  else if (!done.differences.empty())
    desk.errors.push_back(
        drive_error(Errc::negative, node, message("done, but {}", fmt::join(done.differences, "; ")),
                    "check the drive's limits (`param list`, 607Fh, 6080h, 6072h), its gear and its load"));
  for (const auto& text : done.unchecked)
    desk.notices.push_back(message("node {}: {}", node_name(node), text));
  for (const auto& left : done.end.left)
    desk.errors.push_back(
        drive_error(Errc::negative, node, left,
                    left.starts_with("object ")
                        ? "once the drive answers, `write` puts it back, with these bytes behind hex:"
                        : "check the drive before using it"));
  for (const auto& note : done.end.notes)
    desk.notices.push_back(message("node {}: {}", node_name(node), note));
  for (const auto& event : done.events)
    desk.notices.push_back(show::notice_text(event, desk.profile, desk.chinese, &desk.session->network()));
  const double length =
      done.samples.empty() ? 0 : seconds_since(done.samples.back(), done.samples.front().time);
  Record out{{"node", node},
             {"motion", plan.summary},
             {"result", result_text(done)},
             {"differences", report::List(done.differences.begin(), done.differences.end()), Show::json},
             {"unchecked", report::List(done.unchecked.begin(), done.unchecked.end()), Show::json},
             {"seconds", std::round(length * 1000) / 1000},
             {"end", end, Show::text, "drive"},
             {"end", end_record(done.end), Show::json},
             {"by_pdo", done.by_pdo, Show::json},
             {"watchdog", to_string(done.watchdog), Show::json},
             {"preflight", preflight_table(items), Show::json},
             {"summary", summary_of(done.series)}};
  // With -o jsonl the samples went out one by one.
  out.push_back({"samples", desk.keeps_samples ? samples_of(done.series) : report::Value(), Show::json});
  if (plot) out.push_back({"plot", report::Plot{done.series}, Show::text});
  return out;
}

report::Table preflight_table(const std::vector<PreflightItem>& items) {
  report::Table table;
  table.columns = {{"weight", ""}, {"what"}, {"text", "before anything moves"}};
  for (const auto& item : items) table.rows.push_back({name(item.weight), item.what, item.text});
  return table;
}

std::string weight_column(PreflightItem::Weight weight, bool chinese) {
  constexpr std::size_t kWidest = 9;
  const std::string word(name(weight));
  return pad_right(chinese ? report::in_chinese(word) : word, kWidest);
}

std::string preflight_text(const std::vector<PreflightItem>& items, bool chinese) {
  std::string out;
  for (const auto& item : items)
    out += formatted("{}{}{}{}\n", weight_column(item.weight, chinese), printable(item.what),
                     item.what.empty() ? "" : ": ", printable(item.text));
  return out;
}

Record sample_record(const MotionSample& sample, TimePoint begin) {
  Record out{{"time", seconds_since(sample, begin)}, {"statusword", sample.statusword}};
  for (const auto signal : kEverySignal)
    out.push_back({std::string(name(signal)),
                   sample[signal] ? report::Value(rounded(*sample[signal], 9)) : report::Value()});
  return out;
}

std::string sample_line(const MotionSample& sample, TimePoint begin, const MotionUnits& units) {
  auto out = formatted("{:8.3f} s", seconds_since(sample, begin));
  constexpr std::array<std::string_view, kSignals> kShort{"", "", "torque ", "error "};
  for (const auto signal : kEverySignal) {
    const auto value = sample[signal];
    if (!value) continue;
    const auto unit = units.unit(object_of(signal));
    const auto shown = units.of_load(*value, unit).value_or(Physical{*value, unit});
    const auto text =
        formatted("{}{} {}", kShort[static_cast<std::size_t>(signal)], number_text(shown.value), shown.unit);
    out += "  " + pad_left(text, 15);
  }
  return out;
}

Result<void> write_csv(const std::string& path, const std::vector<MotionSample>& samples,
                       const MotionUnits& units) {
  std::string out = "seconds,statusword";
  for (const auto signal : kEverySignal)
    if (units.has(object_of(signal))) out += ',' + csv_heading(name(signal), units.unit(object_of(signal)));
  out += '\n';
  for (const auto& sample : samples) {
    out += formatted("{:.6f},0x{:04X}", seconds_since(sample, samples.front().time), sample.statusword);
    for (const auto signal : kEverySignal) {
      if (!units.has(object_of(signal))) continue;
      const auto value = sample[signal];
      out += value ? "," + plain_number(*value, 9) : ",";
    }
    out += '\n';
  }
  return write_file_atomically(path, out);
}

}  // namespace servoctl::motion
