#include "sim/answer_way.hpp"

#include <algorithm>

#include "canopen/sdo_frame.hpp"

namespace servoctl::sim {
namespace {

/// Longer than the usual timeout of 500 ms, and shorter than twice that.
constexpr Duration kLate = std::chrono::milliseconds(700);

/// Confirms a write, or a part of one (CiA 301, 7.2.4.3.4).
bool confirms_write(const can::Frame& answer) {
  const auto specifier = answer.data[0] & 0xE0U;
  return specifier == 0x60 || specifier == 0x20;
}

void name_next_index(can::Frame& answer) {
  const auto specifier = answer.data[0] & 0xE0U;
  if (specifier == 0x40 || specifier == 0x60 || specifier == 0x80) ++answer.data[1];
}

void name_no_object(can::Frame& answer) {
  if (answer.data[0] == canopen::kSdoAbortCommand) std::fill_n(answer.data.begin() + 1, 3, std::uint8_t{0});
}

}  // namespace

void add_lie(WireFaults& faults, std::string_view word) {
  if (word == "late") faults.late = true;
  if (word == "twice") faults.twice = true;
  if (word == "wrong-index") faults.wrong_index = true;
  if (word == "abort-index") faults.abort_index = true;
  if (word == "short") faults.is_short = true;
  if (word == "unconfirmed") faults.unconfirmed = true;
  if (word == "no-stop") faults.no_stop = true;
}

void AnswerWay::put(can::Frame answer, WireFaults& faults, TimePoint now) {
  const bool every_second = number_++ % 2 == 0;
  if (faults.unconfirmed && confirms_write(answer)) return;
  if (faults.drop_answers > 0) {
    --faults.drop_answers;
    return;
  }
  if (faults.wrong_index && every_second) name_next_index(answer);
  if (faults.abort_index) name_no_object(answer);
  if (faults.is_short) answer.size = 4;
  const bool is_doubled = faults.duplicate_answers > 0 || faults.twice;
  if (faults.duplicate_answers > 0) --faults.duplicate_answers;
  auto time = now + faults.answer_delay + (faults.late && every_second ? kLate : Duration::zero());
  if (!waiting_.empty()) time = std::max(time, waiting_.back().time);
  for (int copies = is_doubled ? 2 : 1; copies > 0; --copies) waiting_.push_back({answer, time});
}

std::optional<can::Frame> AnswerWay::take(TimePoint now) {
  if (waiting_.empty() || waiting_.front().time > now) return std::nullopt;
  const auto out = waiting_.front().frame;
  waiting_.pop_front();
  return out;
}

}  // namespace servoctl::sim
