#pragma once

#include <algorithm>
#include <array>

#include "command/duration_option.hpp"
#include "motion/motion_run.hpp"
#include "motion/written_motion.hpp"

/// What jog, move, home and torque have in common on the command line.
namespace servoctl::command {

inline constexpr Parameter kAccelerationOption{
    .name = "--accel", .help = "ramps (6083h, 6084h); default: 0.5 s to speed", .kind = Kind::value};
inline constexpr Parameter kTurnOption{
    .name = "--turn",
    .help = "increments of 6064h per motor revolution, if the drive does not report it",
    .kind = Kind::number};
inline constexpr Parameter kPanelOption{
    .name = "--panel",
    .help = "PA-20=0,PA-74=1: what the drive's panel shows, for parameters that cannot be read over the bus",
    .kind = Kind::value};
inline constexpr Parameter kIgnoreRemoteOption{
    .name = "--ignore-remote",
    .help = "go on, after a question, although statusword bit 9 (remote) is 0",
    .kind = Kind::flag};
/// What every motion takes.
inline constexpr std::array kMotionOptions{
    Parameter{.name = "--limit", .help = "speed limit; raises the safe default", .kind = Kind::value},
    Parameter{.name = "--max-torque",
              .help = "stop above this torque; for `torque`, the limit",
              .kind = Kind::value},
    Parameter{
        .name = "--max-following-error", .help = "stop above this following error", .kind = Kind::value},
    Parameter{.name = "--window", .help = "stop when it has moved further than this", .kind = Kind::value},
    kTurnOption,
    kPanelOption,
    kIgnoreRemoteOption,
    Parameter{.name = "--master-node", .help = "node-ID of servoctl for the watchdog", .kind = Kind::number},
    Parameter{.name = "--plot", .help = "plot the samples over time at the end", .kind = Kind::flag},
};
inline constexpr Parameter kCsvOption{
    .name = "--csv", .help = "write the samples to this file", .kind = Kind::file};

/// The parameters of a motion command: its own, then what every motion takes.
template <std::size_t N>
constexpr std::array<Parameter, N + kMotionOptions.size()> with_motion_options(
    const std::array<Parameter, N>& own) {
  std::array<Parameter, N + kMotionOptions.size()> out{};
  std::copy(kMotionOptions.begin(), kMotionOptions.end(), std::copy(own.begin(), own.end(), out.begin()));
  return out;
}

/// The options above, as far as they are given. Errc::usage for a number that is none.
Result<motion::MotionOptions> motion_options(const Context& context, const Arguments& arguments);

/// The one node that a motion may have. Errc::usage for several: one motor at a time.
Result<std::uint8_t> one_node(const Context& context);

/// The options above, with the node. Errc::usage as those of one_node() and motion_options().
Result<motion::MotionRequest> motion_request(const Context& context, const Arguments& arguments);

/// The speed of a jog, whose sign is the direction, for check_motion_words().
motion::WrittenQuantity written_speed(std::string_view word);

/// For Command::check of a motion: what its drive lacks for it by its data, what is wrong with the options
/// above, and with quantities of the command's own (whose text is filled in here). Without a family nothing
/// can be said.
Result<void> check_motion_words(const Context& context, const Arguments& arguments, drive::Use use,
                                std::initializer_list<motion::WrittenQuantity> own);

}  // namespace servoctl::command
