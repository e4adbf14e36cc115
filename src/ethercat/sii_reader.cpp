#include "ethercat/sii_reader.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "ethercat/registers.hpp"
#include "ethercat/sii_image.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

constexpr Duration kPause = std::chrono::microseconds(500);  ///< Until a memory that is busy is asked again.
constexpr unsigned kTries = 3;
constexpr std::size_t kSizeWord = 0x3E;
constexpr std::size_t kFetch = 14;  ///< Status, address and data in one read.

}  // namespace

void SiiReader::start(TimePoint now) {
  whole_ = true;
  begin(kSiiHeader, now);
}

void SiiReader::start_head(std::size_t words, TimePoint now) {
  whole_ = false;
  begin(std::min(words, kMaxSiiWords), now);
}

void SiiReader::begin(std::size_t words, TimePoint now) {
  words_ = words;
  image_.clear();
  errors_ = 0;
  lent_ = false;
  held_.reset();
  until_ = now + timeout_;
  go(State::ask_owner, now);
}

void SiiReader::go(State state, TimePoint now, Duration pause) {
  state_ = state;
  asking_ = pause == Duration{};
  deadline_ = asking_ ? kNever : now + pause;
}

void SiiReader::on_time(TimePoint now) {
  if (state_ == State::idle || now < deadline_) return;
  go(state_, now);
}

std::optional<Request> SiiReader::take_request() {
  if (!std::exchange(asking_, false)) return std::nullopt;
  const auto at = store_le(image_.size() / 2, 4);
  switch (state_) {
    case State::idle: return std::nullopt;
    case State::ask_owner: return read_registers(slave_, reg::kSiiAccess, 2);
    case State::take_over: return write_registers(slave_, reg::kSiiAccess, {0});
    case State::ready: return read_registers(slave_, reg::kSiiControl, 2);
    case State::acknowledge: return write_registers(slave_, reg::kSiiControl, {0, 0});
    case State::command:
      return write_registers(slave_, reg::kSiiControl, {0, reg::kSiiRead >> 8U, at[0], at[1], at[2], at[3]});
    case State::fetch: return read_registers(slave_, reg::kSiiControl, kFetch);
    case State::give_back: return write_registers(slave_, reg::kSiiAccess, {reg::kSiiToProcessor});
  }
  return std::nullopt;
}

void SiiReader::on_answer(const Answer& answer, TimePoint now) {
  if (state_ == State::idle) return;
  if (state_ == State::give_back) {
    state_ = State::idle;
    deadline_ = kNever;
    result_ = std::exchange(held_, std::nullopt);
    return;
  }
  if (!answer.done())
    return end(
        fail(error(
            Errc::timeout, answer.lost ? "frames do not come back" : "it does not answer",
            "is it powered, and is the cable leading to it plugged in? `scan` shows which slaves answer")),
        now);
  switch (state_) {
    case State::ask_owner: return on_owner(answer.data, now);
    case State::take_over: return go(State::ask_owner, now);
    case State::ready: return on_ready(answer.data, now);
    case State::acknowledge: return go(State::ready, now);
    case State::command: return go(State::fetch, now);
    case State::fetch: return on_fetched(answer.data, now);
    case State::idle:
    case State::give_back: return;
  }
}

void SiiReader::on_owner(ByteSpan data, TimePoint now) {
  const bool theirs = (data[0] & reg::kSiiToProcessor) != 0;
  const bool busy = (data[1] & reg::kSiiProcessorBusy) != 0;
  if (!theirs && !busy) return go(State::ready, now);
  if (now >= until_)
    return end(
        fail(error(Errc::timeout, "its own processor does not release the SII",
                   "try again in another state: in INIT (`state init`) the SII belongs to the master")),
        now);
  if (!theirs || busy) return go(State::ask_owner, now, kPause);
  lent_ = true;
  go(State::take_over, now);
}

void SiiReader::on_ready(ByteSpan data, TimePoint now) {
  const auto status = word_at(data, 0);
  if ((status & reg::kSiiBusy) != 0) {
    if (now < until_) return go(State::ready, now, kPause);
    return end(fail(error(Errc::timeout, "the memory stays busy", "power cycle the slave")), now);
  }
  if ((status & (reg::kSiiCommandError | reg::kSiiWriteError)) != 0) {
    if (++errors_ > kTries) return on_error(now);
    return go(State::acknowledge, now);
  }
  go(State::command, now);
}

void SiiReader::on_fetched(ByteSpan data, TimePoint now) {
  const auto status = word_at(data, 0);
  if ((status & reg::kSiiBusy) != 0) {
    if (now < until_) return go(State::fetch, now, kPause);
    return end(fail(error(Errc::timeout, "the memory stays busy", "power cycle the slave")), now);
  }
  const auto address = dword_at(data, reg::kSiiAddress - reg::kSiiControl);
  const bool failed = (status & reg::kSiiCommandError) != 0 || address != image_.size() / 2;
  if (failed && ++errors_ > kTries) return on_error(now);
  if (failed) return go((status & reg::kSiiCommandError) != 0 ? State::acknowledge : State::ready, now);
  errors_ = 0;
  const std::size_t size = (status & reg::kSiiEightBytes) != 0 ? 8 : 4;
  take_in(data.subspan(reg::kSiiData - reg::kSiiControl, size), now);
}

void SiiReader::on_error(TimePoint now) {
  end(fail(error(Errc::protocol, message("the memory reports an error at word {:02X}h", image_.size() / 2),
                 "is its memory fitted and programmed, and is no other master reading it?")),
      now);
}

void SiiReader::take_in(ByteSpan data, TimePoint now) {
  image_.insert(image_.end(), data.begin(), data.end());
  until_ = now + timeout_;
  const auto words = needed();
  if (image_.size() / 2 < words) return go(State::command, now);
  image_.resize(2 * words);
  end(std::exchange(image_, {}), now);
}

/// Words up to the end, or to the head of the first category that has not come yet.
std::size_t SiiReader::needed() const {
  const auto have = image_.size() / 2;
  if (!whole_) return words_;
  if (have < kSiiHeader) return kSiiHeader;
  const auto kbits = word_at(image_, 2 * kSizeWord);
  const std::size_t limit =
      kbits == 0 || kbits == 0xFFFF ? kMaxSiiWords : std::min((kbits + std::size_t{1}) * 64, kMaxSiiWords);
  std::size_t at = kSiiHeader;
  while (at + 2 <= std::min(have, limit)) {
    const auto type = word_at(image_, 2 * at);
    const std::size_t words = word_at(image_, 2 * at + 2);
    if (type == kSiiEnd || (type == 0 && words == 0)) return at + 2;
    at += 2 + words;
  }
  return std::min(at + 2, limit);
}

void SiiReader::end(Result<Bytes> result, TimePoint now) {
  if (lent_) {
    held_ = std::move(result);
    return go(State::give_back, now);
  }
  state_ = State::idle;
  asking_ = false;
  deadline_ = kNever;
  result_ = std::move(result);
}

Error SiiReader::error(Errc code, Message what, Message hint) const {
  return drive_error(code, node_, "its SII cannot be read: " + what, std::move(hint));
}

std::optional<Result<Bytes>> SiiReader::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace servoctl::ethercat
