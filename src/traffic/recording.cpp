#include "traffic/recording.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/text.hpp"
#include "can/asc.hpp"
#include "can/candump.hpp"

namespace servoctl::traffic {
namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

/// The next line without its line break; false at the end of the text.
bool take_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const auto end = std::min(text.find('\n'), text.size());
  line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return true;
}

}  // namespace

Result<std::string> read_recording(std::string_view path) { return read_file(std::string(path), kMaxFile); }

Strays for_each_frame(std::string_view text, const std::function<bool(const can::LogFrame&)>& take) {
  const bool asc = can::is_asc(text);
  can::AscReader reader;
  Strays out;
  std::string_view line;
  for (std::size_t number = 1; take_line(text, line); ++number) {
    can::AscLine read;
    if (asc) {
      read = reader.read(line);
    } else if (auto frame = can::parse_log_line(line)) {
      read = {can::AscLine::Kind::frame, std::move(*frame)};
    } else if (auto shown = can::parse_candump_line(line)) {
      read = {can::AscLine::Kind::frame, std::move(*shown)};
    } else if (!trim(line).empty()) {
      read.kind = can::is_candump_fd(line) ? can::AscLine::Kind::unsuited : can::AscLine::Kind::malformed;
    }
    if (read.kind == can::AscLine::Kind::frame && !take(read.frame)) break;
    out.unsuited += read.kind == can::AscLine::Kind::unsuited;
    if (read.kind == can::AscLine::Kind::malformed && out.unknown++ == 0) out.first_line = number;
  }
  return out;
}

std::vector<std::string> notices(std::string_view path, const Strays& strays) {
  std::vector<std::string> out;
  const auto count = [](std::size_t number) {
    return number == 1 ? std::string("1 line") : fmt::format("{} lines", number);
  };
  if (strays.unknown > 0)
    out.push_back(fmt::format("{}: {} no frame and left out, the first is line {}", path,
                              count(strays.unknown) + (strays.unknown == 1 ? " is" : " are"),
                              strays.first_line));
  if (strays.unsuited > 0)
    out.push_back(fmt::format("{}: {} left out: CAN FD or another bus system", path, count(strays.unsuited)));
  return out;
}

tl::unexpected<Error> no_frames(std::string_view path) {
  return fail(Errc::file, fmt::format("{} contains no frames", path),
              "a recording is a candump file (`--trace FILE` writes `candump -L`) or .asc");
}

}  // namespace servoctl::traffic
