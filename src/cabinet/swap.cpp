#include "cabinet/swap.hpp"

#include <algorithm>
#include <iterator>

#include "base/format.hpp"
#include "cabinet/axis_identity.hpp"
#include "cabinet/axis_needs.hpp"
#include "session/family_check.hpp"
#include "session/scan.hpp"
#include "session/storage.hpp"
#include "settings/restoring.hpp"
#include "show/audience.hpp"

namespace servoctl::cabinet {
namespace {

using report::Record;
using report::Show;
using report::Value;
using settings::AddressEnd;

std::string known_serial(const std::optional<std::uint32_t>& serial) {
  return serial ? serial_text(*serial) : "not known";
}

/// One new drive on its way into the cabinet.
class Swapping {
 public:
  Swapping(show::Desk& desk, const Cabinet& cabinet, const Station& station, const SwapOptions& options)
      : line_(&desk), cabinet_(cabinet), station_(station), options_(&options), axis_(*station.axis) {
    desk_ = desk_at(desk, station);
    desk_.audience = desk.audience;
  }

  Result<Value> run() {
    const auto done = carry_out();
    for (auto& notice : desk_.notices) line_->notices.push_back(of_axis(axis_, notice));
    for (auto& error : desk_.errors) line_->errors.push_back(of_axis(axis_, std::move(error)));
    if (!done) return fail(of_axis(axis_, done.error()));
    return answer();
  }

 private:
  Result<void> carry_out() {
    if (const auto found = find(); !found) return found;
    if (const auto fits = hold(); !fits) return fits;
    if (at_ != axis_.node) {
      const auto moved = move();
      if (!moved || desk_.dry_run) return moved;
    }
    if (const auto put = options_->backup.empty() ? apply() : restore(); !put) return put;
    if (!desk_.dry_run) tell_rest();
    return {};
  }

  /// Where the new drive is: one that has been moved already is not looked for at its old node.
  Result<void> find() {
    at_ = options_->from.value_or(axis_.node);
    if (at_ == axis_.node) return {};
    const std::uint8_t both[] = {at_, axis_.node};
    const auto found = session::scan(*desk_.session, both);
    if (!found) return fail(found.error());
    const auto is_there = [&](std::uint8_t node) {
      return std::any_of(found->begin(), found->end(), [&](const auto& one) { return one.node == node; });
    };
    if (is_there(at_) && is_there(axis_.node))
      return fail(drive_error(
          Errc::refused, axis_.node,
          message("the place of {} is taken, and the new drive is at node {}", as_it_is(axis_.name), at_),
          "take the old drive off the bus; `scan --long` shows both"));
    if (!is_there(at_) && !is_there(axis_.node))
      return fail(make_error(Errc::timeout,
                             message("neither node-ID {} nor node-ID {} answers", at_, axis_.node),
                             "is the new drive powered and on this bus? `scan` shows who is there"));
    if (!is_there(at_)) at_ = axis_.node;
    return {};
  }

  Result<void> hold() {
    auto there = axis_;
    there.node = at_;
    there.serial.reset();
    auto identity = hold_axis_identity(desk_, there, options_->apply.choice.families);
    if (!identity) return fail(identity.error());
    identity_ = std::move(*identity);
    is_proven_ = session::judge_family(identity_, *desk_.profile, options_->apply.choice.families).kind ==
                 session::FamilyVerdict::Kind::proven;
    if (const auto own = refuse_listed(); !own) return own;
    is_same_ = axis_.serial.value_or(0) != 0 && identity_.serial == axis_.serial;
    desk_.tell(formatted("{}: a {} at node {}, serial number {}; the file says {}{}\n", axis_.name,
                         axis_.family, at_, known_serial(identity_.serial),
                         serial_text(axis_.serial.value_or(0)),
                         is_same_ ? ": the drive that was there" : ""));
    return {};
  }

  /// A drive that has a place in the cabinet already is not taken out of it.
  Result<void> refuse_listed() const {
    const auto* const at_node = at_ == axis_.node ? nullptr : cabinet_.at(axis_.bus, at_);
    for (const auto& other : cabinet_.axes) {
      if (other.name == axis_.name) continue;
      const bool has_serial = identity_.serial.value_or(0) != 0;
      const bool is_it = has_serial && other.serial == identity_.serial;
      // One that is proven to be of the family of the axis that it is for is none of another's.
      const bool other_family = other.family != axis_.family && is_proven_;
      const bool may_be = &other == at_node && !(has_serial && other.serial) && !other_family;
      if (!is_it && !may_be) continue;
      return fail(drive_error(
          Errc::refused, at_,
          is_it ? message("its serial number is that of axis {} in the file", as_it_is(other.name))
                : message("the file has axis {} there, and nothing tells that this is another drive",
                          as_it_is(other.name)),
          is_it
              ? "is it the new drive? `cabinet plan` shows who is where"
              : message(
                    "where it is the new drive: `address {} -n {} -b {} -d {}` gives it its node, then repeat "
                    "the line without --from; or write `serial` of both into the file, if they have one",
                    axis_.node, at_, as_it_is(axis_.bus), as_it_is(axis_.family))));
    }
    return {};
  }

  Result<void> move() {
    const auto change = settings::plan_address(desk_, at_, {.node = axis_.node, .serial = identity_.serial});
    if (!change) return fail(change.error());
    const std::uint8_t to[] = {axis_.node};
    if (const auto free = settings::refuse_taken(desk_, to); !free) return free;
    if (desk_.dry_run) {
      auto frames = settings::planned_address(desk_, std::span(&*change, 1), options_->address.unlock);
      if (!frames) return fail(frames.error());
      settings_ = std::move(*frames);
      return {};
    }
    if (const auto agreed = desk_.confirm(formatted(
            "Put the drive at node {} into the place of {} (node-ID {})?", at_, axis_.name, axis_.node));
        !agreed)
      return agreed;
    const auto outcome = settings::change_address(desk_, *change, options_->address);
    moved_ = settings::text_of(outcome.end);
    if (outcome.error) return fail(*outcome.error);
    if (outcome.end != AddressEnd::moved)
      return fail(drive_error(
          Errc::negative, at_, message("its node-ID {} holds when it was switched off and on", axis_.node),
          "switch it off and on, then repeat the line: it goes on from there; --wait 5min "
          "waits for it"));
    return {};
  }

  /// The file as it will be: with the serial number of the new drive.
  Result<void> apply() {
    for (auto& axis : cabinet_.axes)
      if (axis.name == axis_.name)
        axis.serial = identity_.serial && axis.serial ? identity_.serial : std::nullopt;
    auto station = station_;
    station.axis = cabinet_.axis(axis_.name);
    const Station stations[] = {station};
    show::Desk desk = desk_at(desk_, station);
    desk.audience = desk_.audience;
    auto done = apply_cabinet(desk, cabinet_, stations, options_->apply);
    take_over(desk);
    if (!done) return fail(done.error());
    settings_ = std::move(*done);
    return {};
  }

  Result<void> restore() {
    const auto file = options_->backup / (axis_.name + ".json");
    const auto backup = settings::read_backup(file);
    if (!backup) return fail(backup.error());
    settings::RestoringOptions how;
    how.keep = options_->apply.keep && session::can_store(*desk_.profile);
    how.unlock = options_->apply.unlock && has_password(*desk_.profile);
    how.resume = options_->apply.resume;
    auto done = settings::put_into(desk_, *backup, as_it_is(file.string()), axis_.node,
                                   before_file(cabinet_, axis_), how);
    if (!done) return fail(done.error());
    settings_ = std::move(done->answer);
    return {};
  }

  void take_over(show::Desk& desk) {
    std::move(desk.notices.begin(), desk.notices.end(), std::back_inserter(desk_.notices));
    std::move(desk.errors.begin(), desk.errors.end(), std::back_inserter(desk_.errors));
  }

  /// What a person has still to do.
  void tell_rest() {
    if (is_same_) {
      desk_.notices.push_back(
          message("axis {}: this is the drive that was there: no drive was exchanged", as_it_is(axis_.name)));
      return;
    }
    if (axis_.serial && identity_.serial && axis_.serial != identity_.serial)
      desk_.notices.push_back(
          message("in {}, [axis.{}]: {}; until then `plan` and `apply` refuse the new drive",
                  as_it_is(cabinet_.file.filename().string()), as_it_is(axis_.name),
                  *identity_.serial == 0 ? Message("take `serial` out, the new drive tells none")
                                         : message("change `serial` to \"0x{:08X}\"", *identity_.serial)));
    desk_.notices.push_back(
        message("axis {}: the encoder's offset and the home position are not among the settings: `home` it, "
                "and check the direction and the limits before it runs",
                as_it_is(axis_.name)));
    if (!desk_.profile->rules.learn.speed.empty())
      desk_.notices.push_back(message("axis {}: counts that `units learn` measured belong to the old drive",
                                      as_it_is(axis_.name)));
    if (options_->backup.empty())
      desk_.notices.push_back(message(
          "axis {}: settings that are not in the file are as the new drive has them: `--backup DIR` restores all "
          "that were saved",
          as_it_is(axis_.name)));
  }

  Value answer() {
    if (desk_.dry_run) return std::move(settings_);
    Record out{{"axis", axis_.name},
               {"node", axis_.node},
               {"family", axis_.family},
               {"serial_before", axis_.serial ? Value(*axis_.serial) : Value(), Show::everywhere,
                "serial in the file"},
               {"serial", identity_.serial ? Value(*identity_.serial) : Value(), Show::everywhere,
                "serial of the drive"},
               {"from", at_},
               {"address", moved_.empty() ? Value("as it is to be") : Value(moved_)},
               {"settings", std::move(settings_)}};
    return Value(std::move(out));
  }

  show::Desk* line_;
  show::Desk desk_;
  Cabinet cabinet_;
  Station station_;
  const SwapOptions* options_;
  Axis axis_;
  std::uint8_t at_ = 0;
  session::Identity identity_;
  bool is_proven_ = false;
  bool is_same_ = false;  ///< The serial number is that of the file.
  std::string moved_;
  Value settings_;
};

}  // namespace

Result<Value> swap_axis(show::Desk& desk, const Cabinet& cabinet, const Station& station,
                        const SwapOptions& options) {
  if (station.away) return fail(of_axis(*station.axis, *station.away));
  return Swapping(desk, cabinet, station, options).run();
}

}  // namespace servoctl::cabinet
