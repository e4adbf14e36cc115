#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "cabinet/cabinet.hpp"
#include "cli/settings.hpp"

/// Which bus holds where a line, the prompt, the environment and a cabinet file may each name one.
namespace servoctl::cli {

/// Adds the notice unless it is there.
void add_once(std::vector<Message>& notices, Message notice);

/// The bus of the file with this name or this URL; null where there is none.
const cabinet::Bus* bus_given(const cabinet::Cabinet& cabinet, const std::string& bus);

/// The settings with the bus that holds where both a bus and a cabinet file are given. The stronger source
/// wins: a bus that loses to the file is taken out, which `notices` say. Errc::usage where both come from one
/// source and the file has no such bus.
Result<Settings> settle_bus(const cabinet::Cabinet& cabinet, Settings settings,
                            std::vector<Message>& notices);

/// Whether all axes that the nodes of the settings name are on its bus. True without names or a bus.
bool are_on_bus(const cabinet::Cabinet& cabinet, const Settings& settings);
/// The same of their family.
bool are_of_family(const cabinet::Cabinet& cabinet, const Settings& settings);

}  // namespace servoctl::cli
