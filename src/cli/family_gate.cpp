#include "cli/family_gate.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "session/family_check.hpp"
#include "session/identify.hpp"
#include "session/scan.hpp"
#include "session/wary.hpp"

namespace servoctl::cli {
namespace {

using session::FamilyVerdict;

Message forcing_hint(std::span<const std::string> fitting, std::uint8_t node, bool is_axis) {
  const Message force = "--force-family continues anyway";
  if (fitting.empty())
    return message("no family fits: check the nameplate; `info -n {}` shows its identity; {}",
                   node_name(node), force);
  if (is_axis)
    return message("its identity fits {}: if the nameplate agrees, correct `family` in the cabinet file; {}",
                   one_of(fitting), force);
  return message("its identity fits {}: if the nameplate agrees, add -d {}; {}", one_of(fitting),
                 as_it_is(fitting.front()), force);
}

}  // namespace

/// Before another family is offered, its own objects are looked for.
std::vector<std::string> FamilyGate::others(session::Identity identity,
                                            std::span<const drive::Family> families) {
  session::look_for_families(*session_, std::span(&identity, 1), families);
  std::vector<std::string> out;
  for (const auto& guess : session::guess_families(identity, families)) out.push_back(guess.family);
  return out;
}

Result<void> FamilyGate::hold(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                              Weight weight) {
  if (nodes.empty() || nodes.front() == 0) return {};
  if (profile != nullptr && weight == Weight::reads) tell_known(nodes, *profile);
  if (profile != nullptr && weight != Weight::reads)
    if (const auto fits = ask_all(nodes, *profile, weight); !fits) return fits;
  // Also with --force-family: what the user named decides.
  if (profile != nullptr)
    for (const auto node : nodes) session::be_wary_of_family(*session_, node, *profile);
  if (weight != Weight::changes) return {};
  if (profile == nullptr && !options_.dry_run)
    if (const auto there = ask_who(nodes); !there) return there;
  return refuse_duplicates(nodes);
}

Result<void> FamilyGate::refuse_duplicates(std::span<const std::uint8_t> nodes) {
  const bool waits = options_.waits && !options_.dry_run;
  const auto heard =
      waits ? session::settle_duplicates(*session_, nodes, session::kBeforeMotion) : session_->listen();
  if (!heard) return heard;
  for (const auto node : nodes)
    if (const auto single = session::refuse_duplicate(*session_, node); !single) return single;
  return {};
}

/// No family is held against them, but two nodes of one number answer.
Result<void> FamilyGate::ask_who(std::span<const std::uint8_t> nodes) {
  const auto identities = session::identify(*session_, nodes, {});
  for (const auto& identity : identities)
    // A recording (replay:) answers nothing but what it was asked; a lost bus fails the command itself.
    if (identity || identity.error().code == Errc::bus) return {};
  return fail(identities.front().error());
}

Result<void> FamilyGate::ask_all(std::span<const std::uint8_t> nodes, const drive::Profile& profile,
                                 Weight weight) {
  const auto identities = session::identify(*session_, nodes, profile.rules);
  const bool must_answer = weight == Weight::changes && !options_.dry_run;
  const bool none =
      std::none_of(identities.begin(), identities.end(), [](const auto& i) { return i.has_value(); });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& identity = identities[i];
    if (identity) {
      if (const auto fits = hold_one(*identity, profile, true); !fits) return fits;
      continue;
    }
    const auto code = identity.error().code;
    if (code == Errc::bus || code == Errc::interrupted || (must_answer && none))
      return fail(identity.error());
    if (must_answer)
      notices_->push_back(
          message("node {} did not answer the identity check: whether it is a {} is not verified",
                  node_name(nodes[i]), as_it_is(profile.family)));
  }
  return {};
}

/// Reads alone are no reason to ask a drive what it is.
void FamilyGate::tell_known(std::span<const std::uint8_t> nodes, const drive::Profile& profile) {
  for (const auto node : nodes)
    if (const auto* known = session_->identities().find(node, session_->watch().boots(node)))
      (void)hold_one(*known, profile, false);
}

Result<void> FamilyGate::hold_one(const session::Identity& identity, const drive::Profile& profile,
                                  bool refuses) {
  const auto families = drive::find_families(options_.folders);
  const auto verdict = session::judge_family(identity, profile, families);
  const auto node = identity.node;
  if (verdict.kind == FamilyVerdict::Kind::proven) return {};
  const bool contradicted = verdict.kind == FamilyVerdict::Kind::contradicted;
  if (contradicted && refuses && !options_.force) {
    auto error =
        drive_error(Errc::refused, node, message("not a {}: {}", as_it_is(profile.family), verdict.why),
                    forcing_hint(others(identity, families), node, !options_.names.of(node).empty()));
    error.object = verdict.object;
    return fail(std::move(error));
  }
  const bool unproven_read = !contradicted && !refuses;
  if (unproven_read || !session_->identities().is_news(node, profile.family + (contradicted ? "!" : "?")))
    return {};
  const std::string_view forced = refuses ? "; continuing because of --force-family" : "";
  notices_->push_back(contradicted ? message("node {}: not a {}: {}{}", node_name(node),
                                             as_it_is(profile.family), verdict.why, forced)
                                   : message("node {}: nothing proves that it is a {}: {}", node_name(node),
                                             as_it_is(profile.family), verdict.why));
  return {};
}

FamilyGate::Weight weight_of(const command::Command& command, const command::Arguments& arguments) {
  switch (command.family) {
    case command::FamilyCheck::by_effect: break;
    case command::FamilyCheck::always:
      return command.effect_with(arguments) >= command::Effect::writes ? FamilyGate::Weight::changes
                                                                       : FamilyGate::Weight::answers;
    case command::FamilyCheck::never: return FamilyGate::Weight::reads;
  }
  return command.effect_with(arguments) >= command::Effect::writes ? FamilyGate::Weight::changes
                                                                   : FamilyGate::Weight::reads;
}

}  // namespace servoctl::cli
