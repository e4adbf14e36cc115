#include "gateway/line_reader.hpp"

namespace servoctl::gateway {

void LineReader::put(std::string_view bytes) {
  bytes_ += bytes;
  forget_surplus();
}

/// What does not belong to its beginning is forgotten as it comes: a line without an end takes no room.
void LineReader::forget_surplus() {
  if (bytes_.size() > longest_ && !has_line()) cut(bytes_.size());
}

/// `size`: where the line ends that is too long.
void LineReader::cut(std::size_t size) {
  bytes_.erase(longest_, size - longest_);
  cut_ = true;
}

std::optional<LineReader::Line> LineReader::take() {
  const auto end = bytes_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  if (end > longest_) {
    cut(end);
    return take();
  }
  Line out{bytes_.substr(0, end), cut_};
  bytes_.erase(0, end + 1);
  cut_ = false;
  forget_surplus();
  if (out.text.ends_with('\r')) out.text.pop_back();
  return out;
}

}  // namespace servoctl::gateway
