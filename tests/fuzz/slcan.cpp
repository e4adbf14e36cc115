// An adapter that says anything: lines are the same however they are cut, frames are frames of the bus, and
// opening it ends.
#include "can/slcan_codec.hpp"

#include <algorithm>
#include <utility>
#include "can/slcan_opening.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

std::vector<can::SlcanLine> lines_in(std::string_view bytes, std::size_t piece) {
  can::SlcanReader reader;
  for (std::size_t at = 0; at < bytes.size(); at += piece) reader.put(bytes.substr(at, piece));
  std::vector<can::SlcanLine> out;
  while (auto line = reader.take()) out.push_back(std::move(*line));
  return out;
}

void check_line(const can::SlcanLine& line) {
  if (line.kind != can::SlcanLine::Kind::frame) return;
  fuzz::require(line.frame.size <= 8, "a classical frame has at most 8 bytes");
  fuzz::require(line.frame.id <= (line.frame.extended ? 0x1FFF'FFFFU : 0x7FFU), "the identifier fits");
  can::SlcanReader reader;
  reader.put(can::slcan_line(line.frame));
  const auto again = reader.take();
  fuzz::require(again && again->frame == line.frame, "a frame written is read again");
}

/// Each line so long after the one before.
void open_with(const std::vector<can::SlcanLine>& lines, Duration distance) {
  TimePoint now{};
  can::SlcanOpening opening('8', can::SlcanOpening::Mode::normal, now);
  for (const auto& line : lines) {
    now += distance;
    opening.on_line(line, now);
    opening.on_time(now);
    (void)opening.take_text();
  }
  for (int steps = 0; !opening.is_done(); ++steps) {
    fuzz::require(steps < 100, "opening ends");
    fuzz::require(opening.deadline() != kNever, "what is under way has a deadline");
    now = std::max(now, opening.deadline());
    opening.on_time(now);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  const auto lines = lines_in(input, input.size() + 1);
  const auto cut = lines_in(input, 1);
  fuzz::require(lines.size() == cut.size(), "a cut makes no line");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    fuzz::require(lines[i].kind == cut[i].kind && lines[i].frame == cut[i].frame &&
                      lines[i].stamp == cut[i].stamp && lines[i].text == cut[i].text,
                  "a cut changes no line");
    check_line(lines[i]);
    if (lines[i].kind == can::SlcanLine::Kind::flags) (void)can::slcan_reports(lines[i].flags);
  }
  for (const int distance : {0, 5'000, 200'000}) open_with(lines, Duration(distance));
  return 0;
}
