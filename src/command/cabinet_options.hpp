#pragma once

#include <vector>

#include "cabinet/station.hpp"
#include "command/command.hpp"

/// What commands on whole cabinets have in common on the command line.
namespace servoctl::command {

inline constexpr Parameter kAxisOption{
    .name = "--axis", .help = "these axes or groups only: feeder,lift (default: all)", .kind = Kind::text};

/// The axes that `--axis` names, all without it; errors as Cabinet::select().
Result<std::vector<const cabinet::Axis*>> chosen_axes(const cabinet::Cabinet& cabinet,
                                                      const Arguments& arguments);

/// Loads the families of the chosen axes and opens their buses. What is not to be had is told at the axes
/// that need it. Errors as chosen_axes(); Errc::usage when no family of theirs has the part that `--only`
/// names.
Result<std::vector<cabinet::Station>> open_stations(Context& context, const cabinet::Cabinet& cabinet,
                                                    const Arguments& arguments);

/// The same for one axis.
cabinet::Station open_station(Context& context, const cabinet::Cabinet& cabinet, const cabinet::Axis& axis);

}  // namespace servoctl::command
