#pragma once

#include <array>
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

  void learn(std::uint8_t node, const drive::Profile& profile) {
    owed_.learn(node, profile, session_->modbus() != nullptr, starts(node));
  }
  /// As OwedRestarts::take_unjudged().
  std::vector<ObjectAddress> take_unjudged(std::uint8_t node) {
    return owed_.take_unjudged(node, starts(node));
  }
  /// Brings the folder up to date: between two lines. Asks a drive who it is where something has changed.
  /// Errc::file.
  Result<void> keep();

 private:
  session::Starts starts(std::uint8_t node);
  Result<void> keep_node(std::uint8_t node);
  void note_answer(const session::Exchange& exchange);
  void note_number(const session::Exchange& exchange);
  bool may_be_over(std::uint8_t node);
  show::OwedRestart record(std::uint8_t node, session::Identity identity);
  void take_from_others(std::uint8_t node, const show::OwedRestartFile& file);
  session::Identity identity_now(std::uint8_t node);

  session::Session* session_;
  std::filesystem::path folder_;
  session::OwedRestarts owed_;
  // Since keep() was called last.
  std::array<bool, 128> silent_{};                  ///< The last transfer of the node was not answered.
  std::array<bool, 128> answered_{};                ///< It was.
  std::array<std::uint32_t, 128> restarts_{};       ///< How often it had started then.
  std::array<session::Identity, 128> heard_{};      ///< What the nodes were heard to say of themselves.
  std::map<std::uint8_t, std::uint32_t> bitrates_;  ///< Of the bus when a bitrate was written to the node.
  std::map<std::uint8_t, std::vector<ObjectAddress>> in_file_;  ///< As this program left it, or found it.
};

}  // namespace servoctl::cli
