#include "gateway/client.hpp"

#include "base/format.hpp"

namespace servoctl::gateway {
namespace {

/// So many times as long as nothing of it may come, an answer may take in all.
constexpr int kMostPatience = 100;

}  // namespace

std::string Client::start(std::string_view request, TimePoint now, Duration patience) {
  patience_ = patience;
  begun_ = now;
  deadline_ = now + patience;
  outcome_.reset();
  return formatted("[{}] {}\r\n", ++sequence_, request);
}

void Client::reset() {
  deadline_ = line_end_ = kNever;
  bare_ = false;
  bytes_.clear();
  looked_ = 0;
  outcome_.reset();
}

void Client::on_bytes(std::string_view bytes, TimePoint now) {
  if (bytes.empty()) return;
  bytes_ += bytes;
  take_lines(bare_ ? "\n" : "\r\n");
  forget_surplus();
  if (busy() && begins_the_answer())
    deadline_ = std::min(now + patience_, begun_ + kMostPatience * patience_);
  line_end_ = busy() && bytes_.ends_with('\n') ? now + kQuiet : kNever;
}

/// Whether what waits for the end of its line is the beginning of the answer: whatever else a gateway says
/// keeps nobody waiting.
bool Client::begins_the_answer() const {
  const auto number = formatted("[{}]", sequence_);
  return std::string_view(bytes_).substr(0, number.size()) == number;
}

/// A line without an end that is not the answer takes no room. Its last byte may be the CR before its LF.
void Client::forget_surplus() {
  if (bytes_.size() <= kLongestOther + 1 || begins_the_answer()) return;
  bytes_.erase(kLongestOther, bytes_.size() - kLongestOther - 1);
  looked_ = kLongestOther;
}

void Client::take_lines(std::string_view end) {
  std::size_t begin = 0;
  for (auto at = bytes_.find(end, looked_); at != std::string::npos; at = bytes_.find(end, begin)) {
    on_line(std::string_view(bytes_).substr(begin, at - begin));
    begin = at + end.size();
  }
  bytes_.erase(0, begin);
  looked_ = bytes_.empty() ? 0 : bytes_.size() - 1;  // The last may be a CR.
}

void Client::on_line(std::string_view line) {
  auto answer = answer_in(line);
  if (!busy() || answer.kind == Answer::Kind::event || answer.sequence != sequence_) return;
  deadline_ = kNever;
  outcome_ = Outcome{false, std::move(answer)};
}

void Client::on_time(TimePoint now) {
  if (now >= line_end_) {
    line_end_ = kNever;
    bare_ = true;
    looked_ = 0;
    take_lines("\n");
  }
  if (!busy() || now < deadline_) return;
  deadline_ = kNever;
  outcome_ = Outcome{true, {}};
}

Answer answer_in(std::string_view lines) {
  auto first = lines.find('\n');
  auto answer = parse_answer(lines.substr(0, first)).value_or(Answer{});
  // What a gateway tells unasked may stand in front.
  while (first != std::string_view::npos && answer.kind == Answer::Kind::event) {
    lines.remove_prefix(first + 1);
    first = lines.find('\n');
    answer = parse_answer(lines.substr(0, first)).value_or(Answer{});
  }
  if (first == std::string_view::npos) return answer;
  constexpr std::string_view kBroken = "...";
  const auto last = lines.substr(lines.rfind('\n') + 1);
  if (!last.starts_with(kBroken)) {
    // Several lines are one value, such as a text with line feeds in it.
    if (answer.kind == Answer::Kind::value) answer.text += lines.substr(first);
    return answer;
  }
  return parse_answer(formatted("[{}] {}", answer.sequence, last.substr(kBroken.size()))).value_or(answer);
}

}  // namespace servoctl::gateway
