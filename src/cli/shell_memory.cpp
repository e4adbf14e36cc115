// What a line leaves for later ones: the family that was named for a drive, and what it wrote that may wait
// for a restart. And whether the drive of an axis is still the one that the file says.
#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>

#include "base/calendar.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "cabinet/axis_identity.hpp"
#include "cli/shell.hpp"
#include "session/family_check.hpp"
#include "session/identify.hpp"
#include "session/node_life.hpp"
#include "show/identity.hpp"
#include "show/known_drive.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::cli {
namespace {

using command::Needs;
using session::Session;
using show::KnownDrive;
using show::KnownDriveFile;

/// A file is found again from another folder; the name of a family is what it is.
std::string lasting_name(const std::string& drive) {
  namespace fs = std::filesystem;
  std::error_code error;
  return fs::is_regular_file(drive, error) ? fs::canonical(drive, error).string() : drive;
}

/// A node answers node guarding within some milliseconds.
constexpr Duration kGuardPatience = std::chrono::milliseconds(200);

/// A stopped node answers no SDO.
Error serial_not_read(const command::Command& command, const cabinet::Axis& axis, Error error) {
  if (error.code != Errc::timeout || !includes(command.needs, Needs::nmt)) return error;
  error.message = message("its serial number cannot be checked: {}", error.message);
  error.hint = message("`nmt preop -n {}` first, if the node is stopped", node_name(axis.node));
  return error;
}

}  // namespace

/// Values of a vendor's objects may wait for a restart: which ones, the data of the family say.
void Shell::judge_writes(Run& run) {
  auto* session = run.context.session;
  auto* watch = session == nullptr ? nullptr : bus_.restarts(*session);
  const auto* known = run.context.profile;
  if (watch == nullptr || (known != nullptr && !known->is_generic())) return;
  for (const auto node : run.context.nodes) {
    const auto written = watch->take_unjudged(node);
    if (node == 0 || written.empty()) continue;
    const auto family = family_by_identity(*session, node);
    const auto found = family.empty() ? Result<const drive::Profile*>(nullptr) : profile(family);
    if (found && *found != nullptr) {
      watch->learn(node, **found);
      keep_restarts();
      if (auto notice =
              show::owed_notice(run.context, node, show::owed_restart(*session, options_.state_folder, node));
          !notice.empty())
        run.context.notices.push_back(std::move(notice));
      continue;
    }
    std::string objects;
    for (const auto object : written) append(objects, to_string(object));
    run.context.notices.push_back(message(
        "node {}: whether {} takes effect at once or after a restart is not known: its manual says it, or add -d FAMILY",
        node_name(node), objects));
  }
}

/// Behind a line, whatever became of it.
void Shell::learn_from(Run& run) {
  tell_contradicted(run);
  if (run.command->path.starts_with("cabinet ")) cabinet_.search_again();
  if (run.context.errors.empty())
    remember_family(run);
  else
    offer_turn(run);
}

/// After a line that worked: which drives the family, and the counts, were said of.
void Shell::remember_family(Run& run) {
  auto* session = run.context.session;
  const auto& settings = run.settings;
  const bool said = !settings.drive.empty() && !run.family_found && !settings.of_cabinet &&
                    run.context.profile != nullptr && !equals_nocase(settings.drive, "online");
  // Nothing there says that it is still the same device.
  if (session != nullptr && session->modbus() != nullptr) return;
  if (!said || session == nullptr || options_.state_folder.empty() || settings.dry_run ||
      settings.force_family || settings.bus.starts_with("replay:") || cancelled())
    return;
  for (const auto node : run.context.nodes) {
    if (node == 0) continue;
    const FoundFamily now{lasting_name(settings.drive), false, run.turn};
    auto& known = families_[key_of(*session, node)];
    if (known == now) continue;
    known = now;
    remember(run, *session, node);
  }
}

/// A line that only read asked nobody what they are: what it shows is in the words of another family. Tells
/// so.
bool Shell::is_contradicted(Run& run, Session& session, const session::Identity& identity) {
  const auto& profile = *run.context.profile;
  const auto verdict = session::judge_family(identity, profile, drive::find_families(options_.drive_folders));
  if (verdict.kind != session::FamilyVerdict::Kind::contradicted) return false;
  if (session.identities().is_news(identity.node, profile.family + "!"))
    run.context.notices.push_back(
        message("node {}: not a {}: {}", node_name(identity.node), as_it_is(profile.family), verdict.why));
  return true;
}

void Shell::remember(Run& run, Session& session, std::uint8_t node) {
  const auto& now = families_[key_of(session, node)];
  const KnownDriveFile file(options_.state_folder, session.url(), node);
  const auto before = file.read();
  const bool same = before && *before && (*before)->family == now.family;
  if (same && (now.turn.empty() || (*before)->turn == now.turn)) return;
  const auto identity = session::read_identity(session, node);
  if (!identity || !session::refuse_duplicate(session, node)) return;
  if (is_contradicted(run, session, *identity)) {
    families_.erase(key_of(session, node));
    return;
  }
  KnownDrive drive{now.family, now.turn, utc_now_text(), *identity};
  if (same && drive.turn.empty()) drive.turn = (*before)->turn;
  if (const auto written = file.write(drive); !written)
    run.context.notices.push_back("the family is not remembered: " + written.error().message);
}

/// Where counts per revolution are missing: those that were once given for this drive are offered, not taken.
void Shell::offer_turn(Run& run) {
  const auto& errors = run.context.errors;
  auto* session = run.context.session;
  if (errors.empty() || !errors.front().hint.says("--turn ") || !run.turn.empty() || session == nullptr ||
      options_.state_folder.empty() || run.context.nodes.size() != 1)
    return;
  const auto node = run.context.nodes.front();
  const auto known = KnownDriveFile(options_.state_folder, session->url(), node).read();
  if (!known || !*known || (*known)->turn.empty()) return;
  const auto identity = session::read_identity(*session, node);
  if (!identity || !show::change_of((*known)->identity, *identity).empty()) return;
  run.context.notices.push_back(
      message("--turn {} was given for this drive at {}: add it if motor, encoder and gear are those of then",
              (*known)->turn, (*known)->time));
}

/// Before something is changed: the drive of an axis is the one that the file says, where it says its serial
/// number; also of a node that is one of its axes and was named by number, or by `all`: those that answer.
Result<void> Shell::hold_serials(Run& run) {
  const auto& nodes = run.context.nodes;
  const bool all = !nodes.empty() && nodes.front() == 0;
  for (const auto* axis : run.on_bus) {
    const bool is_meant = all || std::find(nodes.begin(), nodes.end(), axis->node) != nodes.end();
    if (!is_meant || !axis->serial || run.settings.force_family) continue;
    const auto identity = session::read_identity(*run.context.session, axis->node);
    if (all && !identity && identity.error().code == Errc::timeout) {
      auto life = session::look_from_now(*run.context.session, std::span(&axis->node, 1));
      if (const auto heard = session::hear_who_lives(*run.context.session, life, kGuardPatience); !heard)
        return heard;
      if (!life.front().alive) continue;
    }
    if (!identity) return fail(serial_not_read(*run.command, *axis, identity.error()));
    if (const auto same = cabinet::hold_serial(*axis, *identity); !same) return same;
  }
  return {};
}

}  // namespace servoctl::cli
