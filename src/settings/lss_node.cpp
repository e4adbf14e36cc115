#include "settings/lss_node.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "canopen/node_id.hpp"
#include "canopen/node_list.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"
#include "session/scan.hpp"
#include "settings/address_change.hpp"

namespace servoctl::settings {
namespace {

using canopen::kUnconfigured;
using session::LssDialogue;
using session::LssSlave;

/// From a reset to the boot-up message.
constexpr Duration kLssBootPatience = std::chrono::seconds(5);

/// One slave on its way to its node-ID.
class LssNodeRun {
 public:
  LssNodeRun(show::Desk& desk, const LssSlave& slave, const LssNodeChange& change)
      : desk_(&desk),
        session_(desk.session),
        slave_(&slave),
        change_(&change),
        is_shared_(!shared_lss_node(*desk.session, slave).empty()) {}

  LssNodeOutcome run() {
    const bool stays = has_lss_node(*slave_, *change_);
    if (stays && !change_->keep) {
      out_ = {.result = "nothing to do", .taken = true, .done = true, .strayed = {}, .kept = {}, .error = {}};
      return std::move(out_);
    }
    if (const auto goes_on = session::refuse_cancelled(*session_); !goes_on) {
      fail_with("not changed", goes_on.error());
      return std::move(out_);
    }
    {
      const session::Deaf deaf(*session_);
      if (!configure() || (!stays && !restart())) return std::move(out_);
    }
    if (stays) {
      out_.done = true;
      out_.result = "stored";
      return std::move(out_);
    }
    find();
    return std::move(out_);
  }

 private:
  bool fail_with(std::string result, Error error) {
    out_.result = std::move(result);
    out_.error = std::move(error);
    return false;
  }

  bool configure() {
    LssDialogue lss(*session_, session_->options().timeout);
    const auto selected = lss.select(slave_->address);
    if (!selected) return fail_with("not changed", selected.error());
    if (const auto set = lss.order(canopen::lss_set_node(change_->to), "set its node-ID"); !set)
      return fail_with(set.error().code == Errc::negative ? "not changed" : "not known", set.error());
    if (change_->keep && !store(lss)) return false;
    out_.taken = true;
    if (const auto left = lss.leave(); !left) return fail_with("set; see the error", left.error());
    return true;
  }

  /// A node-ID that comes and goes with the power is worse than the old one.
  bool store(LssDialogue& lss) {
    const auto stored = lss.order(canopen::lss_store(), "stored its configuration",
                                  std::max(session_->options().timeout, kLssStorePatience));
    out_.kept = stored.has_value();
    if (stored) return true;
    auto error = stored.error();
    const auto back =
        lss.order(canopen::lss_set_node(slave_->node.value_or(kUnconfigured)), "taken its old node-ID");
    // It may have stored all the same, and only its answer was lost.
    const bool may_hold = error.code != Errc::negative;
    const bool undone =
        back && (!may_hold || lss.order(canopen::lss_store(), "stored its configuration",
                                        std::max(session_->options().timeout, kLssStorePatience)));
    error.message +=
        !back ? "; and it has not taken its old node-ID back"
        : undone
            ? "; its node-ID is the old one again"
            : "; its node-ID is the old one again, and which of them it has after power-off is not known";
    if (may_hold) out_.kept.reset();
    return fail_with(undone ? "not changed" : "not known", std::move(error));
  }

  bool restart() {
    if (slave_->is_unconfigured() || !slave_->node) return true;
    const auto sent =
        session::restart_node(*session_, *slave_->node, drive::NmtRules::Restart::reset_communication);
    if (!sent) return fail_with("set; holds from its next start", sent.error());
    if (is_shared_)
      desk_->notices.push_back(message(
          "node {}: the other drive of this node-ID was reset as well: its unstored PDOs, COB-IDs and heartbeats are lost",
          node_name(*slave_->node)));
    return true;
  }

  void find() {
    if (change_->to == kUnconfigured) return find_without();
    session::forget_node(*session_, change_->to);
    // The other drive of its number starts as well, and says nothing of this one.
    constexpr std::uint8_t kNobody = 0;
    const auto from = is_shared_                  ? kNobody
                      : slave_->is_unconfigured() ? change_->to
                                                  : slave_->node.value_or(change_->to);
    const auto came =
        session::wait_for_boot(*session_, from, change_->to, session_->now() + kLssBootPatience);
    if (!came) return void(fail_with("set; not looked for", came.error()));
    const auto identity = session::read_identity(*session_, change_->to);
    if (!identity && identity.error().code != Errc::timeout)
      return void(fail_with("set; not found", identity.error()));
    if (identity && is_slave(*identity)) {
      out_.done = true;
      out_.result = slave_->is_unconfigured() ? "node-ID given" : "moved";
      return;
    }
    const auto elsewhere = other_node();
    if (!elsewhere) return void(fail_with("set; not looked for", elsewhere.error()));
    if (*elsewhere) return tell_strayed(**elsewhere);
    if (!identity)
      return void(fail_with(
          "set; not found",
          drive_error(
              Errc::timeout, change_->to, "the slave has taken this node-ID, and does not answer by it",
              change_->keep
                  ? "some start with it only when they are switched off and on, or by `nmt reset-comm -n all`, which resets all nodes"
                  : "some start with it only by `nmt reset-comm -n all`, which resets all nodes; what is not stored is lost with the power")));
    fail_with("set; another answers",
              drive_error(Errc::refused, change_->to,
                          "the drive that answers by this node-ID has another identity (1018h) than "
                          "the LSS slave that was given it",
                          "`scan --long` shows who is there"));
  }

  /// What it does not tell may be the same.
  bool is_slave(const session::Identity& identity) const {
    const auto& a = slave_->address;
    const auto same = [](const std::optional<std::uint32_t>& told, std::uint32_t wanted) {
      return !told || *told == wanted;
    };
    return same(identity.vendor_id, a.vendor) && same(identity.product_code, a.product) &&
           same(identity.revision, a.revision) && same(identity.serial, a.serial);
  }

  /// A slave may confirm one node-ID and take another: the node, neither the old nor the new one, that has
  /// its identity. Nodes are asked for 1018h alone, and for a number of it only where those before it agree.
  Result<std::optional<std::uint8_t>> other_node() {
    const session::OptionScope once(*session_, &session::Options::retries, 0U);
    const auto& a = slave_->address;
    std::vector<std::uint8_t> left;
    for (const auto node : canopen::every_node_id())
      if (node != change_->to && node != slave_->node) left.push_back(node);
    for (const auto& [object, number] :
         {std::pair(objects::kVendorId, a.vendor), std::pair(objects::kProductCode, a.product),
          std::pair(objects::kRevision, a.revision), std::pair(objects::kSerialNumber, a.serial)}) {
      std::vector<session::SdoRequest> requests;
      for (const auto node : left) requests.push_back({node, object, {}});
      const auto answers = session_->transfer(requests);
      std::vector<std::uint8_t> agree;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        const auto code = answers[i] ? Errc::negative : answers[i].error().code;
        if (code == Errc::bus || code == Errc::interrupted) return fail(answers[i].error());
        if (session::u32_in(answers[i]) == number) agree.push_back(left[i]);
      }
      left = std::move(agree);
    }
    return left.empty() ? std::optional<std::uint8_t>() : left.front();
  }

  void tell_strayed(std::uint8_t node) {
    out_.strayed = node;
    fail_with(
        "set; has another node-ID",
        drive_error(Errc::protocol, node,
                    message("it has the identity of the LSS slave that confirmed node-ID {}", change_->to),
                    message("`lss set-node {} -n {}` tries again", change_->to, node_name(node))));
  }

  /// It has no SDO then, and not every slave answers the question for those without a node-ID.
  void find_without() {
    (void)session_->wait([] { return false; }, session_->now() + std::chrono::seconds(1));
    std::vector<std::uint8_t> old;
    if (slave_->node && !slave_->is_unconfigured()) old.push_back(*slave_->node);
    const auto there = session::scan(*session_, old);
    if (!there) return void(fail_with("set; not looked for", there.error()));
    LssDialogue lss(*session_, session_->options().timeout);
    const auto now = lss.select(slave_->address);
    if (!now && now.error().code != Errc::timeout) return void(fail_with("set; not looked for", now.error()));
    out_.done = (there->empty() || is_shared_) && now && now->is_unconfigured();
    out_.result = out_.done ? "without a node-ID now" : "set; holds from its next start";
  }

  show::Desk* desk_;
  session::Session* session_;
  const LssSlave* slave_;
  const LssNodeChange* change_;
  bool is_shared_;  ///< Another drive has its node-ID too, and keeps it.
  LssNodeOutcome out_;
};

/// Before a reset by number: a second drive of it is noticed by what never changes.
Result<void> hold_still(session::Session& session, std::uint8_t node) {
  if (const auto asked = session::read_identity(session, node); !asked) return fail(asked.error());
  const std::uint8_t here[] = {node};
  if (const auto heard = session::settle_duplicates(session, here, session::kBeforeMotion); !heard)
    return heard;
  return refuse_energised(session, node, "its address");
}

}  // namespace

Result<LssSlave> look_at_lss_slave(show::Desk& desk, const LssNodeChange& change) {
  auto& session = *desk.session;
  LssDialogue lss(session, session.options().timeout);
  auto slave = lss.select(change.address);
  if (!slave) return slave;
  if (const auto left = lss.leave(); !left) return fail(left.error());
  const bool stays = has_lss_node(*slave, change);
  if (stays && !change.keep) return slave;
  if (slave->node && !slave->is_unconfigured())
    if (const auto still = hold_still(session, *slave->node); !still) return fail(still.error());
  if (change.to == kUnconfigured || stays) return slave;
  const std::uint8_t target[] = {change.to};
  if (const auto free = refuse_taken(desk, target); !free) return fail(free.error());
  return slave;
}

bool has_lss_node(const LssSlave& slave, const LssNodeChange& change) { return slave.node == change.to; }

std::string shared_lss_node(session::Session& session, const LssSlave& slave) {
  return session::sharers_of(session, slave.node.value_or(kUnconfigured));
}

LssNodeOutcome give_lss_node(show::Desk& desk, const LssSlave& slave, const LssNodeChange& change) {
  return LssNodeRun(desk, slave, change).run();
}

}  // namespace servoctl::settings
