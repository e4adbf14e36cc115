#include "can/replay.hpp"

#include <algorithm>
#include <utility>

#include "base/file.hpp"
#include "base/format.hpp"
#include "can/recording.hpp"

namespace servoctl::can {
namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

/// Whether only a master sends such a frame (CiA 301, 7.3.5; CiA 305).
bool is_of_master(const Frame& frame) {
  if (frame.extended || frame.error) return false;
  return frame.id == 0x000 || frame.remote || (frame.id > 0x600 && frame.id <= 0x67F) || frame.id == 0x7E5;
}

/// `recording.log?channel=can1`: the file, and the bus of it; empty where none is named.
std::pair<std::filesystem::path, std::string> file_and_channel(std::string_view place) {
  constexpr std::string_view kChannel = "?channel=";
  const auto at = place.rfind(kChannel);
  if (at == std::string_view::npos) return {std::filesystem::path(place), {}};
  return {std::filesystem::path(place.substr(0, at)), std::string(place.substr(at + kChannel.size()))};
}

/// Answers of several buses together would be of none of them.
Result<void> check_channel(const std::string& file, std::string_view text, const std::string& channel) {
  const auto buses = frames_of_buses(text);
  if (channel.empty() ? buses.size() < 2 : buses.count(channel) > 0) return {};
  if (!channel.empty())
    return fail(Errc::usage, formatted("{} has no frame of {}", file, channel),
                formatted("it has frames of {}", list_of(buses)));
  return fail(Errc::usage, formatted("{} has frames of several buses: {}", file, list_of(buses)),
              formatted("name the one that is to answer: replay:{}?channel={}", file, buses.begin()->first));
}

TimePoint time_of(const LogFrame& line) { return TimePoint(line.time); }

}  // namespace

ReplayBus::ReplayBus(std::vector<LogFrame> lines, std::string name)
    : lines_(std::move(lines)), done_(lines_.size()), name_(std::move(name)), now_(time_of(lines_.front())) {}

Result<void> ReplayBus::send(const Frame& frame) {
  for (std::size_t i = next_; i < lines_.size(); ++i) {
    if (done_[i] || lines_[i].frame != frame || !is_of_master(frame)) continue;
    done_[i] = true;
    now_ = std::max(now_, time_of(lines_[i]));
    skip_done();
    return {};
  }
  return fail(Errc::bus, formatted("{} is not in the rest of the recording {}", to_string(frame), name_),
              "a recording answers only its original commands, in order; `decode` shows them");
}

Result<std::optional<Frame>> ReplayBus::receive(TimePoint deadline) {
  const bool waits_for_us = next_ < lines_.size() && is_of_master(lines_[next_].frame);
  if (next_ == lines_.size() || waits_for_us || time_of(lines_[next_]) > deadline) {
    // The longest wait without an answer is a day: kNever would be no time.
    now_ = std::max(now_, std::min(deadline, now_ + std::chrono::hours(24)));
    return std::optional<Frame>();
  }
  const auto& line = lines_[next_];
  now_ = std::max(now_, time_of(line));
  done_[next_] = true;
  skip_done();
  return std::optional(line.frame);
}

void ReplayBus::skip_done() {
  while (next_ < lines_.size() && done_[next_]) ++next_;
}

Result<std::unique_ptr<Bus>> open_replay(std::string_view place) {
  const auto [file, channel] = file_and_channel(place);
  const auto text = read_file(file, kMaxFile);
  if (!text) return fail(text.error());
  if (const auto one = check_channel(file.string(), *text, channel); !one) return fail(one.error());
  std::vector<LogFrame> lines;
  const auto strays = for_each_frame(*text, [&, &only = channel](const LogFrame& line) {
    if (only.empty() || line.interface_name == only) lines.push_back(line);
    return true;
  });
  if (strays.damage)
    return fail(
        Errc::file,
        formatted("{} is damaged at byte {}: {}", file.string(), strays.damage->offset, strays.damage->what),
        "`decode` shows what stands in front of that byte");
  if (lines.empty())
    return fail(Errc::file, formatted("{} contains no frames", file.string()),
                "recordings are what `decode` reads; `--trace FILE` writes them");
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return std::make_unique<ReplayBus>(std::move(lines), file.string());
}

}  // namespace servoctl::can
