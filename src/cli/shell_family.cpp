// Which family a line means that names none: the one that was said of the drive before, or, to read only, the
// one that its identity suggests.
#include <fmt/format.h>
#include <algorithm>
#include <utility>
#include <vector>

#include "base/calendar.hpp"
#include "base/text.hpp"
#include "cabinet/axis_identity.hpp"
#include "cli/shell.hpp"
#include "session/family_check.hpp"
#include "session/identify.hpp"
#include "session/node_life.hpp"
#include "session/open_bus.hpp"
#include "session/scan.hpp"
#include "show/identity.hpp"
#include "show/known_drive.hpp"

namespace servoctl::cli {
namespace {

using command::Effect;
using command::Needs;
using session::Identity;
using session::Session;
using show::KnownDrive;
using show::KnownDriveFile;

/// Of a drive that restarts it is found out anew: it may be another one.
std::string key_of(Session& session, std::uint8_t node) {
  return fmt::format("{} {} {}", session::canonical_url(session.url()), node, session.watch().boots(node));
}

/// The families that are for drives of many makers only where no other fits.
std::vector<std::string> suggested(Session& session, Identity identity,
                                   std::span<const drive::Family> families) {
  session::look_for_families(session, std::span(&identity, 1), families);
  const auto guesses = session::guess_families(identity, families);
  const bool own = std::any_of(guesses.begin(), guesses.end(), [](const auto& one) { return !one.generic; });
  std::vector<std::string> out;
  for (const auto& guess : guesses)
    if (!own || !guess.generic) out.push_back(guess.family);
  return out;
}

/// A file is found again from another folder; the name of a family is what it is.
std::string lasting_name(const std::string& drive) {
  namespace fs = std::filesystem;
  std::error_code error;
  return fs::is_regular_file(drive, error) ? fs::canonical(drive, error).string() : drive;
}

tl::unexpected<Error> needs_family(const command::Command& command, std::string hint) {
  return fail(Errc::usage, fmt::format("'{}' needs the drive family", command.path), std::move(hint));
}

/// The families of the nodes of a line, in the order they come.
using Cast = std::vector<std::pair<std::string, std::vector<std::uint8_t>>>;

void add_to(Cast& cast, const std::string& family, std::uint8_t node) {
  auto known = std::find_if(cast.begin(), cast.end(), [&](const auto& one) { return one.first == family; });
  if (known == cast.end()) known = cast.insert(cast.end(), {family, {}});
  known->second.push_back(node);
}

tl::unexpected<Error> several_families(const Cast& cast) {
  std::string lines;
  for (const auto& [family, nodes] : cast)
    append(lines, fmt::format("-n {} -d {}", fmt::join(nodes, ","), family), "; ");
  const auto& [one, here] = cast[0];
  const auto& [other, there] = cast[1];
  return fail(
      Errc::usage,
      fmt::format("node {} is taken for {}, node {} for {}", here.front(), one, there.front(), other),
      fmt::format("a line for each family, if the nameplates agree: {}; or a cabinet file (`cabinet init`)",
                  lines));
}

/// A node answers node guarding within some milliseconds.
constexpr Duration kGuardPatience = std::chrono::milliseconds(200);

/// A stopped node answers no SDO.
Error serial_not_read(const command::Command& command, const cabinet::Axis& axis, Error error) {
  if (error.code != Errc::timeout || !includes(command.needs, Needs::nmt)) return error;
  error.message = fmt::format("its serial number cannot be checked: {}", error.message);
  error.hint = fmt::format("`nmt preop -n {}` first, if the node is stopped", axis.node);
  return error;
}

}  // namespace

const Shell::FoundFamily* Shell::taken_for() const {
  const auto& settings = options_.defaults;
  const auto nodes =
      settings.nodes.empty() ? Result<std::vector<std::uint8_t>>() : parse_nodes(settings.nodes);
  if (!nodes || nodes->size() != 1) return nullptr;
  for (auto* session : bus_.sessions()) {
    if (session::canonical_url(session->url()) != session::canonical_url(settings.bus)) continue;
    const auto found = families_.find(key_of(*session, nodes->front()));
    return found == families_.end() ? nullptr : &found->second;
  }
  return nullptr;
}

std::string Shell::family_in_use() const {
  const auto* taken = options_.defaults.drive.empty() ? taken_for() : nullptr;
  return taken == nullptr ? options_.defaults.drive : taken->family;
}

std::string Shell::family_text() const {
  const auto* taken = options_.defaults.drive.empty() ? taken_for() : nullptr;
  return taken == nullptr ? options_.defaults.drive : taken->family + (taken->guessed ? "?" : "");
}

HeardStates::State Shell::heard_state(std::string_view url, std::uint8_t node, const std::string& family) {
  const auto wanted = session::canonical_url(url);
  const auto data = [&]() -> const drive::Profile* {
    return family.empty() ? nullptr : profile(family).value_or(nullptr);
  };
  for (auto* session : bus_.sessions())
    if (session::canonical_url(session->url()) == wanted) return bus_.heard_state(*session, node, data);
  return {};
}

/// What was said of the drive, as long as it is that drive.
std::optional<KnownDrive> Shell::said_of(Run& run, Session& session, const Identity& identity) {
  if (options_.state_folder.empty()) return std::nullopt;
  const KnownDriveFile file(options_.state_folder, session.url(), identity.node);
  auto known = file.read();
  if (!known) run.context.notices.push_back(known.error().message + "; " + known.error().hint);
  if (!known || !*known) return std::nullopt;
  const auto change = show::change_of((*known)->identity, identity);
  if (change.empty()) return std::move(*known);
  const auto removed = file.remove();
  run.context.notices.push_back(
      fmt::format("node {} is not the drive that was said to be {}: {} is another; {}", identity.node,
                  (*known)->family, change, removed ? "that is forgotten" : removed.error().message));
  return std::nullopt;
}

/// The family of one node, told once. Errc::usage where it is open, or only a guess and something is to be
/// changed.
Result<std::string> Shell::family_of(Run& run, Session& session, std::uint8_t node, bool changes) {
  const auto key = key_of(session, node);
  auto found = families_.find(key);
  if (found == families_.end()) {
    const auto identity = session::read_identity(session, node);
    if (!identity) return fail(identity.error());
    if (const auto said = said_of(run, session, *identity)) {
      run.context.notices.push_back(
          fmt::format("node {} is taken for {}, as said with -d at {} for the drive of this identity", node,
                      said->family, said->time));
      found = families_.emplace(key, FoundFamily{said->family, false}).first;
    } else {
      const auto fits = suggested(session, *identity, drive::find_families(options_.drive_folders));
      if (fits.empty()) return needs_family(*run.command, no_family_hint());
      if (fits.size() > 1 || changes)
        return needs_family(
            *run.command,
            fmt::format("the identity of node {} fits {} (a guess, not proof): if the nameplate "
                        "agrees, add -d {}",
                        node, one_of(fits), fits.front()));
      run.context.notices.push_back(
          fmt::format("node {} is taken for {}, which its identity fits: a guess, not proof; what writes or "
                      "moves needs -d {}",
                      node, fits.front(), fits.front()));
      found = families_.emplace(key, FoundFamily{fits.front(), true}).first;
    }
  }
  if (changes && found->second.guessed)
    return needs_family(
        *run.command,
        fmt::format("node {} is taken for {} by its identity, a guess: if the nameplate agrees, "
                    "add -d {}",
                    node, found->second.family, found->second.family));
  return found->second.family;
}

std::string Shell::no_family_hint() const {
  std::vector<std::string> names;
  for (const auto& family : drive::find_families(options_.drive_folders)) names.push_back(family.name);
  return names.empty() ? std::string("add -d FILE.eds or -d FILE.xml")
                       : fmt::format("add -d {}, or -d with an .eds or .xml file", one_of(names));
}

/// Says what the drives of the line are, where that can be found out.
Result<void> Shell::find_family(Run& run, bool changes) {
  const bool can_look =
      includes(run.command->needs, Needs::node) && !run.settings.nodes.empty() && !run.settings.bus.empty();
  if (!can_look) return needs_family(*run.command, no_family_hint());
  auto nodes = parse_nodes(run.settings.nodes);
  if (!nodes) return fail(nodes.error());
  const auto opened = open(run.settings);
  if (!opened) return fail(opened.error());
  run.context.session = *opened;
  if ((*opened)->modbus() != nullptr)
    return needs_family(*run.command, "registers do not say what a device is: " + no_family_hint());
  if (nodes->front() == 0) nodes = session::nodes_present(**opened);
  if (!nodes) return fail(nodes.error());
  Cast cast;
  for (const auto node : *nodes) {
    // That there are several families is told before what is to be changed of the first one.
    const auto family = family_of(run, **opened, node, changes && nodes->size() == 1);
    if (!family) return fail(family.error());
    add_to(cast, *family, node);
  }
  if (cast.size() > 1) return several_families(cast);
  for (const auto node : *nodes)
    if (const auto sure = changes ? family_of(run, **opened, node, changes) : Result<std::string>(); !sure)
      return fail(sure.error());
  run.settings.drive = cast.front().first;
  run.family_found = true;
  run.family_guessed = families_.at(key_of(**opened, nodes->front())).guessed;
  return {};
}

/// Behind a line, whatever became of it.
void Shell::learn_from(Run& run) {
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
        fmt::format("node {}: not a {}: {}", identity.node, profile.family, verdict.why));
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
  if (errors.empty() || errors.front().hint.find("--turn") == std::string::npos || !run.turn.empty() ||
      session == nullptr || options_.state_folder.empty() || run.context.nodes.size() != 1)
    return;
  const auto node = run.context.nodes.front();
  const auto known = KnownDriveFile(options_.state_folder, session->url(), node).read();
  if (!known || !*known || (*known)->turn.empty()) return;
  const auto identity = session::read_identity(*session, node);
  if (!identity || !show::change_of((*known)->identity, *identity).empty()) return;
  run.context.notices.push_back(fmt::format(
      "--turn {} was given for this drive at {}: add it if motor, encoder and gear are those of then",
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
