#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "drive/bitrate.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"
#include "session/scan.hpp"
#include "session/stretch.hpp"
#include "settings/address_change.hpp"
#include "settings/address_write.hpp"
#include "settings/own_cob_ids.hpp"
#include "show/identity.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::settings {
namespace {

using session::Identity;

/// From an NMT reset to the boot-up message.
constexpr Duration kBootPatience = std::chrono::seconds(10);
constexpr Duration kSecondLook = std::chrono::seconds(1);

bool tells_itself_apart(const Identity& identity) { return identity.serial.value_or(0) != 0; }

std::string serial_text(const Identity& identity) {
  return identity.serial ? formatted("serial number {}", *identity.serial) : "no serial number";
}

/// One drive on its way to its new address.
class AddressRun {
 public:
  AddressRun(show::Desk& desk, const AddressChange& change, const AddressOptions& options)
      : desk_(&desk), session_(desk.session), change_(&change), options_(&options) {}

  AddressOutcome run() {
    if (change_->idle()) {
      out_.end = AddressEnd::nothing_to_do;
      return std::move(out_);
    }
    if (const auto goes_on = session::refuse_cancelled(*session_); !goes_on) {
      fail_with(AddressEnd::as_before, goes_on.error());
      return std::move(out_);
    }
    if (change_->writes.empty() || write_address(*desk_, *change_, *options_, out_)) restart();
    return std::move(out_);
  }

  AddressOutcome find_from(AddressOutcome so_far) {
    out_ = std::move(so_far);
    find();
    return std::move(out_);
  }

 private:
  bool fail_with(AddressEnd end, Error error) {
    out_.end = end;
    out_.error = std::move(error);
    return false;
  }

  void restart() {
    if (!change_->moves() && !change_->bitrate && change_->writes.empty()) return;
    out_.end = AddressEnd::awaits_restart;
    if (change_->bitrate || (!change_->restarts() && options_->patience == Duration::zero())) return;
    if (!change_->restarts())
      desk_->tell(formatted("switch node {} off and on again now: it is waited for at node {} for {}\n",
                            change_->node, change_->to, to_string(options_->patience)));
    if (const auto sent = session::restart_node(*session_, change_->node, change_->restart); !sent) {
      fail_with(AddressEnd::failed, written_but(sent.error()));
      return;
    }
    if (change_->moves()) session::forget_node(*session_, change_->to);
    const auto patience = change_->restarts() ? kBootPatience : options_->patience;
    const session::Stretch stretch(*session_, session_->now() + patience, session::Stretch::End::at_latest);
    const auto came =
        session::wait_for_boot(*session_, change_->node, change_->to, session_->now() + patience);
    if (came)
      find();
    else
      fail_with(AddressEnd::failed, written_but(came.error()));
  }

  Error written_but(Error error) const {
    error.message = message("node {} was told to be node {}; whether it is one by now is not known: {}",
                            node_name(change_->node), change_->to, error.message);
    error.hint = "`scan` shows who answers";
    error.node = change_->node;
    return error;
  }

  Error about(Errc code, Message what, Message hint) const {
    return drive_error(code, change_->node, what, std::move(hint));
  }

  /// Who answers at the two nodes. A boot-up that was heard may have been another's, and some answer only a
  /// while behind theirs: where nobody is at the new one, once more.
  Result<std::vector<Identity>> look() {
    const std::uint8_t both[] = {change_->node, change_->to};
    const auto nodes = std::span(both).first(change_->moves() ? 2U : 1U);
    auto found = session::scan(*session_, nodes);
    const auto is_new = [&](const Identity& identity) { return identity.node == change_->to; };
    if (!found || std::any_of(found->begin(), found->end(), is_new)) return found;
    const auto waited = session_->wait([] { return false; }, session_->now() + kSecondLook);
    if (!waited) return fail(waited.error());
    return session::scan(*session_, nodes);
  }

  void find() {
    const auto found = look();
    if (!found) {
      fail_with(AddressEnd::failed, written_but(found.error()));
      return;
    }
    const auto at = [&](std::uint8_t node) {
      return std::find_if(found->begin(), found->end(), [&](const Identity& i) { return i.node == node; });
    };
    const auto here = at(change_->to);
    const bool old = change_->moves() && at(change_->node) != found->end();
    if (here == found->end()) return not_there(old);
    // What it did not answer in the search is no difference.
    const auto identity = session::read_identity(*session_, change_->to);
    if (!identity)
      fail_with(AddressEnd::failed, written_but(identity.error()));
    else if (!show::change_of(change_->identity, *identity).empty())
      fail_with(AddressEnd::failed,
                about(Errc::refused,
                      message("node {} answers now, but is another drive: {}, and {} before", change_->to,
                              serial_text(*identity), serial_text(change_->identity)),
                      "`scan --long` shows who is there"));
    else if (old)
      fail_with(AddressEnd::failed,
                about(Errc::negative,
                      message("it answers as node {0} now, and node {1} still answers: two drives had the "
                              "node-ID {1}, or one has two",
                              change_->to, change_->node),
                      "`scan --long` shows both"));
    else
      arrived();
  }

  void not_there(bool old) {
    if (change_->bitrate)
      return void(
          fail_with(AddressEnd::failed,
                    about(Errc::timeout, message("no answer at {}", drive::bitrate_text(*change_->bitrate)),
                          "switch it off and on: at another bitrate it disturbs the others")));
    if (!old)
      return void(fail_with(
          AddressEnd::failed,
          about(Errc::timeout, message("neither node {} nor node {} answers", change_->node, change_->to),
                change_->restarts() ? "switch it off and on, and look with `scan`"
                                    : "is it still off? `scan` shows who answers")));
    const auto& name = desk_->profile->rules.nmt.node_id;
    const auto place = drive::place_of(*desk_->profile, name);
    const auto held = session_->upload(change_->node, *place);
    if (held && load_le(*held) != change_->to)
      return void(fail_with(
          AddressEnd::failed,
          about(Errc::negative,
                message("it forgot its new address when it restarted: {} is {} again", name, load_le(*held)),
                "does it keep its values? `store` may be refused, or its flash be worn")));
    out_.end = AddressEnd::awaits_restart;
    const std::string_view why = change_->restarts() ? "the NMT command did not put its new address in force"
                                                     : "it was not switched off and on";
    out_.error = about(Errc::negative, message("still answers at its old address: {}", why),
                       message("switch it off and on; then it is node {}", change_->to));
  }

  void arrived() {
    // It has restarted.
    show::OwedRestartFile(desk_->state_folder, session_->url(), change_->node).remove();
    out_.end = change_->bitrate ? AddressEnd::at_bitrate : AddressEnd::moved;
    if (!change_->moves()) return;
    if (!tells_itself_apart(change_->identity))
      desk_->notices.push_back(
          message("node {}: it tells no serial number of its own: that it is the drive that was node {} is "
                  "known by its kind alone",
                  node_name(change_->to), node_name(change_->node)));
    const auto now = read_own_cob_ids(*desk_, change_->to);
    if (!now) {
      out_.error = now.error();
      return;
    }
    out_.stayed = left_behind(change_->node, change_->cob_ids, *now);
    tell_stayed(*now);
  }

  void tell_stayed(const session::Values& now) {
    if (out_.stayed.empty()) return;
    std::vector<std::string> each;
    for (const auto object : out_.stayed)
      each.push_back(formatted("{} = 0x{:08X}", to_string(object), load_le(now.at(object))));
    desk_->notices.push_back(
        message("node {}: COB-IDs that did not follow, and still are those of node {}: {}; where that is not "
                "meant, `pdo show -n {} -d {}` shows them, and `write` puts them right",
                node_name(change_->to), change_->node, NameList{each}, node_name(change_->to),
                as_it_is(change_->profile->family)));
  }

  show::Desk* desk_;
  session::Session* session_;
  const AddressChange* change_;
  const AddressOptions* options_;
  AddressOutcome out_;
};

}  // namespace

AddressOutcome change_address(show::Desk& desk, const AddressChange& change, const AddressOptions& options) {
  const FamilyScope family(desk, change.profile);
  return AddressRun(desk, change, options).run();
}

AddressOutcome find_again(show::Desk& desk, const AddressChange& change, AddressOutcome so_far) {
  const FamilyScope family(desk, change.profile);
  const AddressOptions none;
  return AddressRun(desk, change, none).find_from(std::move(so_far));
}

}  // namespace servoctl::settings
