#include "traffic/recording.hpp"

#include <fmt/format.h>

#include "base/file.hpp"

namespace servoctl::traffic {
namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

}  // namespace

Result<std::string> read_recording(std::string_view path) { return read_file(std::string(path), kMaxFile); }

std::vector<std::string> notices(std::string_view path, const Strays& strays) {
  std::vector<std::string> out;
  const std::string_view unit = strays.records ? "record" : "line";
  const auto count = [&](std::size_t number) {
    return fmt::format("{} {}{}", number, unit, number == 1 ? "" : "s");
  };
  if (strays.unknown > 0)
    out.push_back(fmt::format("{}: {} no frame and left out, the first is {} {}", path,
                              count(strays.unknown) + (strays.unknown == 1 ? " is" : " are"), unit,
                              strays.first));
  if (strays.unsuited > 0)
    out.push_back(fmt::format("{}: {} left out: CAN FD or another bus system", path, count(strays.unsuited)));
  return out;
}

Result<void> check_damage(std::string_view path, const Strays& strays) {
  if (!strays.damage) return {};
  return fail(Errc::file,
              fmt::format("{} is damaged at byte {}: {}", path, strays.damage->offset, strays.damage->what),
              "was it copied before it was complete? What stands in front of that byte is read");
}

tl::unexpected<Error> no_frames(std::string_view path) {
  return fail(
      Errc::file, fmt::format("{} contains no CAN frames", path),
      "a recording is a candump file (`--trace FILE` writes `candump -L`), .asc, .trc, .blf, or a pcap or "
      "pcapng of a CAN interface");
}

}  // namespace servoctl::traffic
