#pragma once

#include <span>
#include <string>
#include <vector>

#include "command/command.hpp"
#include "session/session.hpp"
#include "show/axis_names.hpp"

namespace servoctl::cli {

/// The one place where a command is held against what the drives are, before it sends anything: the family
/// that was named against their identity, and whether two nodes have one number.
class FamilyGate {
 public:
  struct Options {
    drive::Folders folders;  ///< Of the families that may fit instead.
    bool force = false;      ///< --force-family
    bool dry_run = false;
    bool waits = false;  ///< For a second node that answers late: something is to move, or to be stored.
    show::AxisNames names = {};  ///< Whose family the cabinet file says: -d does not.
  };

  FamilyGate(session::Session& session, const Options& options, std::vector<Message>& notices)
      : session_(&session), options_(options), notices_(&notices) {}

  /// What a command asks for: to change something, to tell what makes sense for the family alone, or to read
  /// plainly, where nothing is asked of the drives and what is known already is told.
  enum class Weight : std::uint8_t { reads, answers, changes };

  /// Errc::refused when the identity of a node contradicts the family (unless forced), or when two nodes of
  /// the number were noticed and something is to be changed. What proves nothing is told once a node.
  /// `profile` may be null: then no family was named. Where no node answers that is to be changed, its error.
  Result<void> hold(std::span<const std::uint8_t> nodes, const drive::Profile* profile, Weight weight);

 private:
  Result<void> refuse_duplicates(std::span<const std::uint8_t> nodes);
  Result<void> ask_who(std::span<const std::uint8_t> nodes);
  Result<void> hold_one(const session::Identity& identity, const drive::Profile& profile, bool refuses);
  Result<void> ask_all(std::span<const std::uint8_t> nodes, const drive::Profile& profile, Weight weight);
  std::vector<std::string> others(session::Identity identity, std::span<const drive::Family> families);
  void tell_known(std::span<const std::uint8_t> nodes, const drive::Profile& profile);

  session::Session* session_;
  Options options_;
  std::vector<Message>* notices_;
};

/// How much a command weighs with these arguments, by its data.
FamilyGate::Weight weight_of(const command::Command& command, const command::Arguments& arguments);

}  // namespace servoctl::cli
