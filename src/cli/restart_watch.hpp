#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "session/owed_restarts.hpp"
#include "session/session.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::cli {

/// Keeps in the folder for state which values of the nodes of a session wait for a restart. It hears every
/// transfer, and every restart while the bus is open.
class RestartWatch {
 public:
  /// Lives no longer than the session, and goes before whoever is told of its transfers otherwise. Takes up
  /// what the folder has; empty: nothing is kept.
  RestartWatch(session::Session& session, std::filesystem::path state_folder);
  RestartWatch(const RestartWatch&) = delete;
  RestartWatch& operator=(const RestartWatch&) = delete;

  void learn(std::uint8_t node, const drive::Profile& profile) { owed_.learn(node, profile); }
  /// Brings the folder up to date: between two lines. Asks a drive who it is where something has changed.
  /// Errc::file.
  Result<void> keep();

 private:
  session::Starts starts(std::uint8_t node);
  Result<void> keep_node(std::uint8_t node);
  void take_from_others(std::uint8_t node, const show::OwedRestartFile& file);
  session::Identity identity_now(std::uint8_t node);

  session::Session* session_;
  std::filesystem::path folder_;
  session::OwedRestarts owed_;
  std::map<std::uint8_t, std::vector<ObjectAddress>> in_file_;  ///< As this program left it, or found it.
};

}  // namespace servoctl::cli
