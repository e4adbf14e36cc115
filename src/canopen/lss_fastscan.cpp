#include "canopen/lss_fastscan.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::canopen {
namespace {

constexpr std::uint8_t kTopBit = 31;
constexpr std::uint8_t kLastPart = 3;

}  // namespace

LssFastscan::LssFastscan(Options options) : options_(options), master_({}) {}

void LssFastscan::start(TimePoint now) {
  asked_twice_ = false;
  result_.reset();
  steps_ = 0;
  whole_ = false;
  step_ = {.bit = kFastscanBegin};
  ask(now);
}

void LssFastscan::ask(TimePoint now) {
  // Only behind the last answer does it matter how many there are.
  const bool last = whole_ && step_.part == kLastPart;
  const auto further = last ? options_.patience : std::min(options_.patience, options_.further);
  master_.set_options({.patience = options_.patience, .further = further});
  master_.start(lss_fastscan(step_), now);
}

void LssFastscan::on_time(TimePoint now) {
  master_.on_time(now);
  const auto answers = master_.take_result();
  if (!answers) return;
  ++steps_;
  if (step_.bit == kFastscanBegin)
    on_begun(answers->size(), now);
  else if (whole_)
    on_number(answers->size(), now);
  else
    on_bit(answers->size(), now);
}

void LssFastscan::on_begun(std::size_t answers, TimePoint now) {
  if (answers > 0) return begin_part(0, now);
  if (std::exchange(asked_twice_, true)) {
    result_ = std::optional<Found>();
    return;
  }
  ask(now);
}

void LssFastscan::begin_part(std::uint8_t part, TimePoint now) {
  whole_ = false;
  step_ = {.bit = kTopBit, .part = part, .next = part};
  ask(now);
}

void LssFastscan::on_bit(std::size_t answers, TimePoint now) {
  if (answers == 0) step_.number |= 1U << step_.bit;
  if (step_.bit > 0) {
    --step_.bit;
  } else {
    whole_ = true;
    step_.next = step_.part == kLastPart ? 0 : static_cast<std::uint8_t>(step_.part + 1);
  }
  ask(now);
}

void LssFastscan::on_number(std::size_t answers, TimePoint now) {
  if (answers == 0) {
    result_ = fail(Errc::protocol,
                   "LSS slaves without a node-ID answer to single bits of an identity, and none to all of it",
                   "late or lost answers, or a slave that was switched off: `lss scan` again, with a longer "
                   "--patience");
    return;
  }
  numbers_[step_.part] = step_.number;
  if (step_.part != kLastPart) return begin_part(step_.next, now);
  result_ = std::optional(Found{{numbers_[0], numbers_[1], numbers_[2], numbers_[3]}, answers});
}

std::optional<Result<std::optional<LssFastscan::Found>>> LssFastscan::take_result() {
  return std::exchange(result_, std::nullopt);
}

}  // namespace servoctl::canopen
