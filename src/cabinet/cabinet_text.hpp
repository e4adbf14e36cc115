#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "session/identity.hpp"
#include "settings/backup_file.hpp"
#include "show/desk.hpp"

/// A cabinet file made from what is on a bus.
namespace servoctl::cabinet {

/// One drive as it was found.
struct FoundAxis {
  std::string name;
  std::uint8_t node = 0;
  std::string family;               ///< Empty: nothing fits; the axis stands in comments.
  bool guessed = false;             ///< Of its identity, not said by the user.
  std::vector<std::string> others;  ///< Families that fit as well.
  session::Identity identity;
  std::string pdo_file;  ///< With its PDOs, where they are not as from the factory.
  std::optional<std::uint16_t> heartbeat_ms;
  std::optional<double> increments;  ///< In one turn of the motor, where the drive tells them.
  /// `Pn0202 = 400  # Position loop gain 1`: what is not as from the factory.
  std::vector<std::string> parameters;
};

/// What of a drive is not as from the factory, in the words of the file; PDOs go into a file of their own,
/// whose text is the second of the pair, empty where they are as from the factory. Node-ID and bitrate are
/// left out, and what cannot be said in one value. Only reads.
struct FoundSettings {
  std::size_t unstated = 0;  ///< Settings without a known factory value, also those left out of the file.
  std::vector<std::string> parameters;
  std::optional<std::uint16_t> heartbeat_ms;
  std::optional<double> increments;  ///< In one turn of the motor, where the drive tells them.
  std::string pdos;
};
Result<FoundSettings> find_settings(show::Desk& desk, std::uint8_t node);

/// The text of a bus and its axes, with comments that say what is to be filled in. `whole`: with what stands
/// at the head of a file.
std::string cabinet_text(const std::string& bus, const std::string& url, const std::vector<FoundAxis>& axes,
                         bool whole, bool chinese);

}  // namespace servoctl::cabinet
