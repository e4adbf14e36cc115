#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <vector>

#include "command/front_end.hpp"
#include "show/desk.hpp"

namespace servoctl::command {

/// The desk of one command line: with what its words and the front end add.
struct Context : show::Desk {
  drive::Folders drive_folders;
  std::map<std::uint8_t, const drive::Profile*> families;  ///< Of single nodes (Command::family_by_node).
  std::vector<const cabinet::Axis*> axes;  ///< That the nodes are; empty where they are just nodes.
  bool nodes_typed = false;                ///< In the line itself; else by `use` or the environment.
  bool read_only = false;                  ///< Nothing in a drive may be changed.
  bool stays_open = false;                ///< Other lines follow on the same session: a prompt, a batch file.
  bool disables_at_end = false;           ///< Whoever leaves de-energises what was enabled: a prompt.
  FrontEnd* front_end = nullptr;          ///< Null: there is none, and nothing is held.
  std::span<Context* const> others = {};  ///< The other buses and families of the line (Command::joins).
  Context* failed = nullptr;              ///< Of `others`, the one whose bus ended the run.

  /// As FrontEnd::hold_family().
  Result<void> hold_family(std::span<const std::uint8_t> of, const drive::Profile* family,
                           bool changes) const {
    return front_end == nullptr ? Result<void>() : front_end->hold_family(of, family, changes);
  }
};

}  // namespace servoctl::command
