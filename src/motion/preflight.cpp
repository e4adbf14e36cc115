#include "motion/preflight.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/provenance.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "motion/operation_mode.hpp"
#include "motion/other_axes.hpp"
#include "motion/power.hpp"
#include "report/catalogue.hpp"
#include "show/caution_text.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::motion {
namespace {

using Weight = PreflightItem::Weight;

/// Settings and readings that are shown as they are.
struct Shown {
  ObjectAddress object;
  std::string_view what;
};
constexpr std::array kShown{
    Shown{objects::kSupplyVoltage, "supply"},
    Shown{objects::kFollowingErrorWindow, "following error window"},
    Shown{{0x607F, 0}, "max speed"},
    Shown{{0x6080, 0}, "max motor speed"},
    Shown{{0x607D, 1}, "lower position limit"},
    Shown{{0x607D, 2}, "upper position limit"},
    Shown{{0x6072, 0}, "max torque"},
};

/// The manual does not state the unit of everything.
std::string value_text(const Physical& value) {
  return value.unit.empty() ? formatted("{} (unit not known)", number_text(value.value))
                            : formatted("{} {}", number_text(value.value), value.unit);
}

class Preflight {
 public:
  Preflight(session::Session& session, const MotionUnits& units, std::uint8_t node, bool chinese,
            PreflightRequest request)
      : session_(&session), units_(&units), node_(node), chinese_(chinese), request_(std::move(request)) {}

  Result<std::vector<PreflightItem>> run() {
    if (const auto done = look_at_state(); !done) return fail(done.error());
    look_at_axes();
    tell_owed();
    if (const auto done = look_at_needs(); !done) return fail(done.error());
    if (const auto done = look_at_objects(); !done) return fail(done.error());
    if (const auto done = look_at_cautions(); !done) return fail(done.error());
    look_at_data();
    return std::move(items_);
  }
  Result<std::vector<PreflightItem>> run_state() {
    if (const auto done = look_at_state(); !done) return fail(done.error());
    if (const auto done = look_at_inputs(); !done) return fail(done.error());
    return std::move(items_);
  }

 private:
  void add(Weight weight, std::string_view what, std::string text) {
    items_.push_back({weight, std::string(what), std::move(text)});
  }

  /// A drive that obeys process data only is not in OP yet.
  bool sleeps() const {
    return session_->network().carries(session::LifeSign::Kind::process_data) &&
           session_->watch().state(node_) != session::NodeState::operational;
  }

  Result<void> look_at_state() {
    Power power(*session_, units_->profile(), node_);
    const auto word = power.statusword();
    if (!word) return fail(word.error());
    const auto state = drive::decode_state(*word);
    const bool fault = state == drive::DriveState::fault || state == drive::DriveState::fault_reaction_active;
    const bool waits = state == drive::DriveState::not_ready_to_switch_on;
    const bool asleep = waits && sleeps();
    const bool bad = fault || drive::is_energised(state) || (waits && !asleep);
    auto text =
        formatted("{} (statusword 0x{:04X})", chinese_ ? drive::name_zh(state) : drive::name(state), *word);
    if (fault) text += ": `fault show` says why, `fault reset` resets it once the cause is gone";
    if (!fault && drive::is_energised(state)) text += ": it is or may be enabled; `disable` it first";
    if (asleep)
      text += ": outside OP some drives do not run their state machine; it is looked at again in OP";
    add(bad ? Weight::stop : asleep ? Weight::note : Weight::good, "state", std::move(text));
    if ((*word & kWarning) != 0) add(Weight::caution, "warning", "statusword bit 7 (warning) is set");
    if ((*word & kInternalLimit) != 0)
      add(Weight::caution, "limit", "statusword bit 11: internal limit active");
    if (!asleep && power.tells(kRemote) && (*word & kRemote) == 0) add_remote(power);
    const auto mode = read_mode(*session_, node_);
    if (!mode) return fail(mode.error());
    add(Weight::good, "mode", mode_text(units_->profile(), *mode, chinese_));
    return {};
  }

  /// Until every command knows axes: which one is meant, and that nobody commands another.
  void look_at_axes() {
    const auto others = other_axes(*session_, &units_->profile(), node_);
    if (others.empty()) return;
    const bool energised = std::any_of(others.begin(), others.end(),
                                       [](const OtherAxis& axis) { return axis.may_be_energised(); });
    auto hint =
        energised ? std::string("`disable` takes the power of all axes of the node away") : std::string();
    items_.push_back(
        {energised ? Weight::stop : Weight::caution, "axes", axes_text(others), std::move(hint)});
  }

  /// What a low bit 9 says differs from drive to drive; some set it in the state operational only.
  void add_remote(const Power& power) {
    constexpr std::string_view kLead = "statusword bit 9 (remote) is 0";
    const auto& source = request_.source;
    names_source_ = source.has_value();
    const auto start = power.start_command();
    auto text = source ? formatted("{}: {}", kLead, source->cause())
                       : formatted("{}, the drive may not obey the bus: {}", kLead, kRemoteCauses);
    if (!source && !start.empty()) text += "; or it sets the bit in the state operational only";
    if (request_.ignores_remote) {
      add(Weight::caution, "remote", std::move(text));
      return;
    }
    auto way = std::string("return control to the bus");
    if (source)
      way = source->remedy(units_->profile(), node_);
    else if (!start.empty())
      way = formatted("`{}`, or {}", start, way);
    items_.push_back({Weight::stop, "remote", std::move(text),
                      formatted("{}; --ignore-remote goes on after a question", way)});
  }

  Result<void> look_at_inputs() {
    if (!units_->has(objects::kDigitalInputs)) return {};
    const auto answer = session_->upload(node_, objects::kDigitalInputs);
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    if (answer) add_inputs(static_cast<std::uint32_t>(load_le(*answer)));
    return {};
  }

  Result<void> look_at_objects() {
    if (const auto done = look_at_inputs(); !done) return done;
    std::vector<session::SdoRequest> requests;
    std::vector<std::string_view> names;
    for (const auto& shown : kShown) {
      if (!units_->has(shown.object)) continue;
      requests.push_back({.node = node_, .object = shown.object});
      names.push_back(shown.what);
    }
    const auto answers = session_->transfer(requests);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers[i] && answers[i].error().code != Errc::sdo_abort) return fail(answers[i].error());
      if (!answers[i]) continue;
      if (const auto value = units_->physical(requests[i].object, *answers[i])) {
        if (value->value != 0 || requests[i].object == objects::kFollowingErrorWindow ||
            requests[i].object == objects::kSupplyVoltage)
          add(Weight::note, names[i], value_text(*value));
      }
    }
    return {};
  }

  /// Limits are shown and do not stop: which motion they are in the way of is not known.
  void add_inputs(std::uint32_t word) {
    const auto& rules = units_->profile().rules;
    auto text = drive::switch_words(rules.motion, word);
    const bool known = rules.motion.inputs_known;
    const bool limit = known && (rules.motion.is_actuated(word, rules.motion.inputs[0]) ||
                                 rules.motion.is_actuated(word, rules.motion.inputs[1]));
    if (rules.is_assumed("motion.inputs_active_low"))
      text += " (assumed: the manual does not state the active level)";
    const auto weight = limit ? Weight::caution : known ? Weight::good : Weight::note;
    add(weight, "inputs", formatted("60FDh is 0x{:08X}: {}", word, text));
  }

  void tell_owed() {
    if (request_.owed.unread)
      add(Weight::caution, "restart",
          formatted("what waits for a restart is not known: {}", request_.owed.unread->message.text()));
    if (request_.owed.values.empty()) return;
    add(Weight::caution, "restart",
        formatted("{}: {}", show::owed_lead(request_.owed.values),
                  show::owed_text(&units_->profile(), node_, request_.owed.values, chinese_)));
  }

  /// What has to be set before the drive listens to CANopen.
  Result<void> look_at_needs() {
    for (const auto& need : units_->profile().rules.nmt.needs) {
      if (names_source_ && request_.source->name == need.name) continue;
      const auto now = setting_of(*session_, *units_, need.name, request_.owed.values);
      if (!now) return fail(now.error());
      const auto other = std::ranges::find_if(
          *now, [&](const auto& value) { return value && *value != static_cast<double>(need.value); });
      if (other != now->end())
        add(Weight::caution, need.name,
            formatted("it is {}, and {} is needed for CANopen: the drive may not obey", **other, need.value));
    }
    return {};
  }

  static constexpr std::string_view kUnread = "{} cannot be read (check the panel): ";

  /// What cannot be read may hold.
  Result<void> look_at_cautions() {
    const auto concerns = [this](const drive::Caution& rule) {
      return !request_.purpose || rule.concerns_use(request_.purpose->exposure());
    };
    const auto held = held_cautions(*session_, *units_, request_.panel, request_.owed.values, concerns);
    if (!held) return fail(held.error());
    for (const auto& [rule, unread] : *held) {
      const auto lead =
          !unread ? std::string()
                  : formatted(fmt::runtime(chinese_ ? report::chinese_word(kUnread) : kUnread), rule->name);
      add(Weight::caution, "", lead + show::caution_text(units_->profile(), *rule, chinese_));
    }
    for (const auto& [name, value] : request_.panel)
      add(Weight::note, name, formatted("{} by --panel: servoctl cannot read it", value));
    return {};
  }

  /// A drive that is simulated in this process is made from the same data: it proves nothing about them.
  void look_at_data() {
    const auto& url = session_->url();
    if (url.starts_with("sim:") || url.find(":sim:") != std::string::npos) return;
    add(Weight::note, "data",
        formatted("the drive data were checked against: {}",
                  drive::provenance_text(units_->profile(), chinese_)));
  }

  session::Session* session_;
  const MotionUnits* units_;
  std::uint8_t node_;
  bool chinese_;
  PreflightRequest request_;
  std::vector<PreflightItem> items_;
  bool names_source_ = false;  ///< Why the drive does not obey was said with bit 9 of the statusword.
};

}  // namespace

std::string_view name(PreflightItem::Weight weight) {
  constexpr std::array<std::string_view, 4> kNames{"ok", "note", "caution", "stop"};
  return kNames[static_cast<std::size_t>(weight)];
}

Result<std::vector<PreflightItem>> preflight(session::Session& session, const MotionUnits& units,
                                             std::uint8_t node, bool chinese, PreflightRequest request) {
  return Preflight(session, units, node, chinese, std::move(request)).run();
}

Result<void> look_in_op(session::Session& session, const MotionUnits& units, std::uint8_t node, bool chinese,
                        std::span<const PreflightItem> shown, const AskAgain& ask,
                        const PreflightRequest& request) {
  const auto items = Preflight(session, units, node, chinese, request).run_state();
  if (!items) return fail(items.error());
  if (const auto possible = check_preflight(*items, node); !possible) return possible;
  std::vector<PreflightItem> unseen;
  for (const auto& item : *items) {
    const bool was_shown = std::any_of(shown.begin(), shown.end(), [&](const PreflightItem& one) {
      return one.what == item.what && one.text == item.text;
    });
    if (item.weight == Weight::caution && !was_shown) unseen.push_back(item);
  }
  if (unseen.empty()) return {};
  if (!ask)
    return fail(drive_error(Errc::refused, node,
                            message("in OP, {}: {}", unseen.front().what, unseen.front().text),
                            "nothing was moved; outside OP the drive did not report this"));
  if (const auto answer = ask(unseen); !answer) return answer;
  // A person may have taken time to answer.
  const auto again = Preflight(session, units, node, chinese, request).run_state();
  if (!again) return fail(again.error());
  return check_preflight(*again, node);
}

PreflightItem watchdog_item(const WatchdogPlan& watchdog) {
  return {watchdog.stops() == Stops::yes ? Weight::good : Weight::caution, "watchdog", to_string(watchdog)};
}

Result<void> check_preflight(const std::vector<PreflightItem>& items, std::uint8_t node) {
  for (const auto& item : items)
    if (item.weight == Weight::stop)
      return fail(drive_error(Errc::refused, node, message("{}: {}", item.what, item.text),
                              item.hint.empty() ? std::string("nothing was moved") : item.hint));
  return {};
}

}  // namespace servoctl::motion
