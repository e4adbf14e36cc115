#include "settings/lss_crowd.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "base/format.hpp"
#include "canopen/node_id.hpp"
#include "session/addressing.hpp"
#include "session/identify.hpp"

namespace servoctl::settings {
namespace {

using canopen::LssService;
using session::LssDialogue;

/// Who is to change, as far as LSS tells: their node-IDs, and how many have none.
struct Crowd {
  std::vector<std::uint8_t> nodes;
  std::size_t others = 0;  ///< Slaves without a node-ID that are not meant.
};

Result<Crowd> crowd_of(session::Session& session, const LssBitrateChange& change) {
  LssDialogue lss(session, session.options().timeout);
  Crowd out;
  if (change.all) {
    const auto answers = all_lss_answers(lss);
    if (!answers) return fail(answers.error());
    for (const auto& answer : *answers)
      if (const auto node = answer.number & 0xFFU; node <= canopen::kLastNode)
        out.nodes.push_back(static_cast<std::uint8_t>(node));
  } else {
    const auto slave = lss.select(change.address);
    if (!slave) return fail(slave.error());
    if (slave->node && !slave->is_unconfigured()) out.nodes.push_back(*slave->node);
    if (const auto left = lss.leave(); !left) return fail(left.error());
    const auto without = lss.ask(canopen::lss_identify_unconfigured());
    if (!without) return fail(without.error());
    const std::size_t own = slave->is_unconfigured() ? 1 : 0;
    out.others = without->size() - std::min(own, without->size());
  }
  if (const auto left = lss.leave(); !left) return fail(left.error());
  return out;
}

/// A number of the crowd that somebody else has, too.
std::optional<std::uint8_t> node_of_two(session::Session& session, const Crowd& crowd) {
  for (const auto node : crowd.nodes)
    if (!session::sharers_of(session, node).empty() && std::ranges::count(crowd.nodes, node) < 2) return node;
  return std::nullopt;
}

}  // namespace

Result<LssDialogue::Answers> all_lss_answers(LssDialogue& lss) {
  if (const auto reset = lss.ask(canopen::lss_switch_all(canopen::LssState::waiting)); !reset)
    return fail(reset.error());
  if (const auto sent = lss.select_all(); !sent) return fail(sent.error());
  return lss.ask(canopen::lss_inquire(LssService::inquire_node));
}

Result<void> leave_nobody_behind(session::Session& session, const LssBitrateChange& change,
                                 BitrateSwitch& plan) {
  if (!plan.follows()) return {};
  const auto crowd = crowd_of(session, change);
  if (!crowd) return fail(crowd.error());
  const auto others = session::nodes_beside(session, crowd->nodes);
  if (!others) return fail(others.error());
  if (const auto heard = session::settle_duplicates(session, crowd->nodes, session::kBriefly); !heard)
    return heard;
  const auto shared = node_of_two(session, *crowd);
  if (shared)
    plan.why_not = formatted("two drives are node {}, and one of them would be left at {}", *shared,
                             old_bitrate_text(plan));
  else if (!others->empty())
    plan.why_not =
        formatted("node{} {} would be left at {}: no LSS slave, or not one that is meant",
                  others->size() == 1 ? "" : "s", fmt::join(*others, ", "), old_bitrate_text(plan));
  else if (crowd->others > 0)
    plan.why_not = formatted("an LSS slave without a node-ID would be left at {}: --all takes it along",
                             old_bitrate_text(plan));
  return {};
}

}  // namespace servoctl::settings
