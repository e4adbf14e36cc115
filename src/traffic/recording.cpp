#include "traffic/recording.hpp"

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::traffic {
namespace {

constexpr std::uintmax_t kMaxFile = std::uintmax_t{1} << 30U;

/// What is told of the file, how many, and where the first is.
struct StrayWords {
  std::string_view no_frame;
  std::string_view no_frames;
  std::string_view unsuited;
  std::string_view several_unsuited;
};
constexpr StrayWords kLines{"{0}: 1 line is no frame and left out, the first is line {2}",
                            "{0}: {1} lines are no frame and left out, the first is line {2}",
                            "{0}: 1 line left out: CAN FD or another bus system",
                            "{0}: {1} lines left out: CAN FD or another bus system"};
constexpr StrayWords kRecords{"{0}: 1 record is no frame and left out, the first is record {2}",
                              "{0}: {1} records are no frame and left out, the first is record {2}",
                              "{0}: 1 record left out: CAN FD or another bus system",
                              "{0}: {1} records left out: CAN FD or another bus system"};

}  // namespace

Result<std::string> read_recording(std::string_view path) {
  return read_file(path == "-" ? std::string("/dev/stdin") : std::string(path), kMaxFile);
}

std::vector<Message> notices(std::string_view path, const Strays& strays) {
  std::vector<Message> out;
  const auto& words = strays.records ? kRecords : kLines;
  const auto tell = [&](std::size_t count, std::string_view one, std::string_view several) {
    if (count > 0)
      out.push_back(message(fmt::runtime(count == 1 ? one : several), as_it_is(path), count, strays.first));
  };
  tell(strays.unknown, words.no_frame, words.no_frames);
  tell(strays.unsuited, words.unsuited, words.several_unsuited);
  if (strays.assumed_base != 0)
    out.push_back(message(
        fmt::runtime(
            strays.assumed_base == 16
                ? "{}: identifiers are read as hexadecimal, by how the data are written; `--columns` can say "
                  "otherwise"
                : "{}: identifiers are read as decimal, by how the lines are written; `--columns` can say "
                  "otherwise"),
        as_it_is(path)));
  if (strays.assumed_data_base != 0)
    out.push_back(message(
        fmt::runtime(
            strays.assumed_data_base == 16
                ? "{}: data are read as hexadecimal, as the identifiers are; `--columns` can say otherwise"
                : "{}: data are read as decimal, as the identifiers are; `--columns` can say otherwise"),
        as_it_is(path)));
  if (strays.lacks_unit)
    out.push_back(
        message("{}: the times have no unit and are left out; `--columns` can name it: time:ms, time:us",
                as_it_is(path)));
  return out;
}

Result<void> check_damage(std::string_view path, const Strays& strays) {
  if (!strays.damage) return {};
  if (strays.damage->joined)
    return fail(Errc::file,
                message("{}: byte {}: {}", as_it_is(path), strays.damage->offset, strays.damage->what),
                "two recordings were joined: split the file there; what comes before that byte is read");
  return fail(
      Errc::file,
      message("{} is damaged at byte {}: {}", as_it_is(path), strays.damage->offset, strays.damage->what),
      "was it copied before it was complete? What stands in front of that byte is read");
}

Result<void> check_base(std::string_view path, const Strays& strays) {
  if (strays.open_base == 0) return {};
  return fail(
      Errc::usage,
      message("{}: nothing in it says whether its numbers are decimal or hexadecimal (line {})",
              as_it_is(path), strays.open_base),
      "say it with the columns: `--columns time,id:hex,data:hex` or `--columns time,id:dec,data:dec`");
}

Result<void> check_base_is_certain(std::string_view path, const Strays& strays) {
  if (strays.assumed_base == 0 && strays.assumed_data_base == 0) return check_base(path, strays);
  return fail(
      Errc::usage,
      message(fmt::runtime(strays.assumed_base != 0
                               ? "{}: nothing in it says whether its identifiers are decimal or hexadecimal"
                               : "{}: nothing in it says whether its data are decimal or hexadecimal"),
              as_it_is(path)),
      "frames are sent only if it is certain: say it with the columns, `--columns time,id:hex,data:hex`");
}

Strays for_each_frame_of(std::string_view recording, std::string_view channel, const can::TakeLogFrame& take,
                         const can::ReadOptions& options) {
  const auto of_channel = [&](const can::LogFrame& line) {
    return (!channel.empty() && line.interface_name != channel) || take(line);
  };
  return for_each_frame(recording, of_channel, options);
}

Result<void> check_channel(std::string_view path, std::string_view recording, std::string_view channel,
                           const can::ReadOptions& options) {
  const auto frames = can::frames_of_buses(recording, options);
  if (channel.empty() ? frames.size() < 2 : frames.count(std::string(channel)) > 0) return {};
  const auto list = can::list_of(frames);
  if (!channel.empty())
    return fail(Errc::usage, message("{} has no frame of {}", as_it_is(path), as_it_is(channel)),
                message("it has frames of {}", as_it_is(list)));
  return fail(Errc::usage, message("{} has frames of several buses: {}", as_it_is(path), as_it_is(list)),
              message("sent on one bus they would mean something else: name one, `--channel {}`",
                      as_it_is(frames.begin()->first)));
}

tl::unexpected<Error> no_frames(std::string_view path, const Strays& strays) {
  if (strays.ethercat > 0)
    return fail(Errc::file, message("{} is a capture of EtherCAT, not of CAN", as_it_is(path)),
                "Wireshark shows the datagrams of EtherCAT; decode reads CAN");
  if (!strays.first_text.empty())
    return fail(
        Errc::file,
        message("{} contains no CAN frames; line {} is '{}'", as_it_is(path), strays.first,
                as_it_is(strays.first_text)),
        "if that is a frame, name its columns: `--columns time,id,data`; recordings of candump, .asc, .trc, "
        ".blf, pcap and many tools need none");
  return fail(
      Errc::file, message("{} contains no CAN frames", as_it_is(path)),
      "a recording is a candump file (`monitor --trace FILE` writes one), .asc, .trc, .blf, or a pcap or "
      "pcapng of a CAN interface");
}

}  // namespace servoctl::traffic
