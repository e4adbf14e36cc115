// Which family a line means that names none: the one that was said of the drive before, or, to read only, the
// one that its identity suggests.
#include <fmt/format.h>
#include <algorithm>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cli/shell.hpp"
#include "session/identify.hpp"
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

/// What an identity says of the family.
struct Suggestion {
  std::vector<std::string> families;
  bool proven = false;  ///< There is one, its rules say that a match is certain, and no other fits.
};

/// The families that are for drives of many makers only where no other fits.
Suggestion suggested(Session& session, Identity identity, std::span<const drive::Family> families) {
  session::look_for_families(session, std::span(&identity, 1), families);
  const auto guesses = session::guess_families(identity, families);
  const bool own = std::any_of(guesses.begin(), guesses.end(), [](const auto& one) { return !one.generic; });
  Suggestion out;
  for (const auto& guess : guesses)
    if (!own || !guess.generic) out.families.push_back(guess.family);
  out.proven = out.families.size() == 1 && std::any_of(guesses.begin(), guesses.end(), [](const auto& one) {
                 return one.certain && !one.generic;
               });
  return out;
}

tl::unexpected<Error> needs_family(const command::Command& command, Message hint) {
  return fail(Errc::usage, message("'{}' needs the drive family", as_it_is(command.path)), std::move(hint));
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
    append(lines, formatted("-n {} -d {}", fmt::join(nodes, ","), family), "; ");
  const auto& [one, here] = cast[0];
  const auto& [other, there] = cast[1];
  return fail(
      Errc::usage,
      message("node {} is taken for {}, node {} for {}", node_name(here.front()), one,
              node_name(there.front()), other),
      message("a line for each family, if the nameplates agree: {}; or a cabinet file (`cabinet init`)",
              lines));
}

}  // namespace

/// Of a drive that restarts it is found out anew: it may be another one.
std::string Shell::key_of(Session& session, std::uint8_t node) {
  return formatted("{} {} {}", session::canonical_url(session.url()), node, session.watch().boots(node));
}

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
  run.context.notices.push_back(message("node {} is not the drive that was said to be {}: {} is another; {}",
                                        node_name(identity.node), as_it_is((*known)->family), change,
                                        removed ? "that is forgotten" : removed.error().message));
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
          message("node {} is taken for {}, as said with -d at {} for the drive of this identity",
                  node_name(node), as_it_is(said->family), said->time));
      found = families_.emplace(key, FoundFamily{said->family, false}).first;
    } else {
      const auto [fits, proven] = suggested(session, *identity, drive::find_families(options_.drive_folders));
      if (fits.empty()) return needs_family(*run.command, no_family_hint());
      if (fits.size() > 1 || (changes && !proven))
        return needs_family(*run.command,
                            message("the identity of node {} fits {} (a guess, not proof): if the nameplate "
                                    "agrees, add -d {}",
                                    node_name(node), one_of(fits), as_it_is(fits.front())));
      run.context.notices.push_back(
          proven ? message("node {} is a {}: its identity proves it", node_name(node), fits.front())
                 : message("node {} is taken for {}, which its identity fits: a guess, not proof; what "
                           "writes or moves needs -d {}",
                           node_name(node), fits.front(), fits.front()));
      found = families_.emplace(key, FoundFamily{fits.front(), !proven, {}, proven}).first;
    }
  }
  if (changes && found->second.guessed)
    return needs_family(
        *run.command,
        message("node {} is taken for {} by its identity, a guess: if the nameplate agrees, "
                "add -d {}",
                node_name(node), as_it_is(found->second.family), as_it_is(found->second.family)));
  return found->second.family;
}

/// Of a drive that a line has written to without naming its family: what was found out of it or said with -d,
/// else the one family that its identity fits. Empty where none is known. A file without a family, and the
/// standard, are none.
std::string Shell::family_by_identity(Session& session, std::uint8_t node) {
  const auto is_own = [this](const std::string& family) {
    const auto loaded = profile(family);
    return loaded && *loaded != nullptr && !(*loaded)->is_generic();
  };
  if (const auto found = families_.find(key_of(session, node));
      found != families_.end() && is_own(found->second.family))
    return found->second.family;
  if (session.modbus() != nullptr) return {};
  const auto identity = session::read_identity(session, node);
  if (!identity) return {};
  if (!options_.state_folder.empty()) {
    const auto known = KnownDriveFile(options_.state_folder, session.url(), node).read();
    if (known && *known && show::change_of((*known)->identity, *identity).empty() && is_own((*known)->family))
      return (*known)->family;
  }
  const auto fits = suggested(session, *identity, drive::find_families(options_.drive_folders)).families;
  return fits.size() == 1 && is_own(fits.front()) ? fits.front() : std::string();
}

Message Shell::no_family_hint() const {
  std::vector<std::string> names;
  for (const auto& family : drive::find_families(options_.drive_folders)) names.push_back(family.name);
  return names.empty() ? Message("add -d FILE.eds or -d FILE.xml")
                       : message("add -d {}, or -d with an .eds or .xml file", one_of(names));
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
  const auto& found = families_.at(key_of(**opened, nodes->front()));
  run.family_guessed = found.guessed;
  run.family_proven = found.proven;
  return {};
}

}  // namespace servoctl::cli
