#include "canopen/lss_master.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::canopen {

void LssMaster::start(LssRequest request, TimePoint now) {
  request_ = std::move(request);
  next_ = 0;
  answers_.clear();
  result_.reset();
  state_ = State::sending;
  deadline_ = now;
  at_most_ = kNever;
  on_time(now);
}

void LssMaster::on_frame(const can::Frame& frame, TimePoint now) {
  if (state_ != State::listening) return;
  const auto answer = parse_lss_answer(frame);
  if (!answer || answer->service != request_.answer) return;
  if (answers_.size() < kMostAnswers) answers_.push_back(*answer);
  if (at_most_ == kNever) at_most_ = now + options_.patience + kMostAnswers * options_.further;
  deadline_ = std::min(at_most_, now + options_.further);
}

void LssMaster::on_time(TimePoint now) {
  if (now < deadline_) return;
  if (state_ == State::listening) return finish();
  if (state_ != State::sending || tx_) return;
  tx_ = request_.frames[next_++];
  if (next_ < request_.frames.size()) {
    deadline_ = now + options_.gap;
    return;
  }
  if (!request_.answer) return finish();
  state_ = State::listening;
  deadline_ = now + options_.patience;
}

void LssMaster::finish() {
  state_ = State::idle;
  deadline_ = kNever;
  result_ = std::exchange(answers_, {});
}

std::optional<can::Frame> LssMaster::take_frame() { return std::exchange(tx_, std::nullopt); }

std::optional<LssMaster::Answers> LssMaster::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::canopen
