#include "can/replay.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "can/recording.hpp"

namespace servoctl::can {
namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

/// Whether only a master sends such a frame (CiA 301, 7.3.5; CiA 305).
bool is_of_master(const Frame& frame) {
  if (frame.extended || frame.error) return false;
  return frame.id == 0x000 || frame.remote || (frame.id > 0x600 && frame.id <= 0x67F) || frame.id == 0x7E5;
}

/// `recording.log?channel=can1&columns=time,id,data`
struct ReplayPlace {
  std::string file;
  std::string channel;  ///< Empty where none is named.
  std::optional<ColumnChoice> columns;
};

Result<ReplayPlace> parse_place(std::string_view place) {
  constexpr std::string_view kChannel = "channel=";
  constexpr std::string_view kColumns = "columns=";
  ReplayPlace out;
  for (auto mark = place.rfind('?'); mark != std::string_view::npos; mark = std::string_view::npos) {
    const auto words = place.substr(mark + 1);
    // A file may have the mark in its name.
    if (!words.starts_with(kChannel) && !words.starts_with(kColumns)) break;
    for (const auto word : split(words, '&')) {
      if (word.starts_with(kChannel)) out.channel = word.substr(kChannel.size());
      if (!word.starts_with(kColumns)) continue;
      auto columns = ColumnChoice::parse(word.substr(kColumns.size()));
      if (!columns) return fail(columns.error());
      out.columns = std::move(*columns);
    }
    place = place.substr(0, mark);
  }
  out.file = place;
  return out;
}

/// Answers of several buses together would be of none of them.
Result<void> check_channel(const ReplayPlace& place, std::string_view text, const ReadOptions& read) {
  const auto buses = frames_of_buses(text, read);
  const auto& [file, channel, columns] = place;
  if (channel.empty() ? buses.size() < 2 : buses.count(channel) > 0) return {};
  if (!channel.empty())
    return fail(Errc::usage, message("{} has no frame of {}", as_it_is(file), as_it_is(channel)),
                message("it has frames of {}", as_it_is(list_of(buses))));
  return fail(Errc::usage,
              message("{} has frames of several buses: {}", as_it_is(file), as_it_is(list_of(buses))),
              message("name the one that is to answer: replay:{}?channel={}", as_it_is(file),
                      as_it_is(buses.begin()->first)));
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
  return fail(Errc::bus,
              message("{} is not in the rest of the recording {}", to_string(frame), as_it_is(name_)),
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
  const auto from = parse_place(place);
  if (!from) return fail(from.error());
  const auto& file = from->file;
  const auto text = read_file(file, kMaxFile);
  if (!text) return fail(text.error());
  const ReadOptions read{.columns = from->columns ? &*from->columns : nullptr};
  if (const auto one = check_channel(*from, *text, read); !one) return fail(one.error());
  std::vector<LogFrame> lines;
  const auto take = [&](const LogFrame& line) {
    if (from->channel.empty() || line.interface_name == from->channel) lines.push_back(line);
    return true;
  };
  const auto strays = for_each_frame(*text, take, read);
  if (strays.damage)
    return fail(
        Errc::file,
        message("{} is damaged at byte {}: {}", as_it_is(file), strays.damage->offset, strays.damage->what),
        "`decode` shows what stands in front of that byte");
  if (strays.open_base != 0 || strays.assumed_base != 0 || strays.assumed_data_base != 0)
    return fail(
        Errc::usage,
        message("{}: nothing in it says whether its identifiers are decimal or hexadecimal", as_it_is(file)),
        "say it behind the file: `?columns=time,id:hex,data:hex`");
  if (lines.empty())
    return fail(Errc::file, message("{} contains no frames", as_it_is(file)),
                "recordings are what `decode` reads; `monitor --trace FILE` writes one");
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return std::make_unique<ReplayBus>(std::move(lines), file);
}

}  // namespace servoctl::can
