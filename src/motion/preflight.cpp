#include "motion/preflight.hpp"

#include <fmt/format.h>
#include <array>

#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/provenance.hpp"
#include "drive/standard_objects.hpp"
#include "motion/operation_mode.hpp"
#include "motion/power.hpp"
#include "report/catalogue.hpp"

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

class Preflight {
 public:
  Preflight(session::Session& session, const MotionUnits& units, std::uint8_t node, bool chinese)
      : session_(&session), units_(&units), node_(node), chinese_(chinese) {}

  Result<std::vector<PreflightItem>> run() {
    if (const auto done = look_at_state(); !done) return fail(done.error());
    if (const auto done = look_at_needs(); !done) return fail(done.error());
    if (const auto done = look_at_objects(); !done) return fail(done.error());
    if (const auto done = look_at_cautions(); !done) return fail(done.error());
    look_at_data();
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
        fmt::format("{} (statusword 0x{:04X})", chinese_ ? drive::name_zh(state) : drive::name(state), *word);
    if (fault) text += ": `fault show` says why, `fault reset` resets it once the cause is gone";
    if (!fault && drive::is_energised(state)) text += ": it is or may be enabled; `disable` it first";
    if (asleep)
      text += ": outside OP some drives do not run their state machine; it is looked at again in OP";
    add(bad ? Weight::stop : asleep ? Weight::note : Weight::good, "state", std::move(text));
    if ((*word & kWarning) != 0) add(Weight::caution, "warning", "statusword bit 7 (warning) is set");
    if ((*word & kInternalLimit) != 0)
      add(Weight::caution, "limit", "statusword bit 11: internal limit active");
    if (!asleep && power.tells(kRemote) && (*word & kRemote) == 0)
      add(Weight::stop, "remote", "statusword bit 9 (remote) is 0: the drive obeys its panel, not the bus");
    const auto mode = read_mode(*session_, node_);
    if (!mode) return fail(mode.error());
    add(Weight::good, "mode", mode_text(units_->profile(), *mode, chinese_));
    return {};
  }

  Result<void> look_at_objects() {
    std::vector<session::SdoRequest> requests;
    std::vector<std::string_view> names;
    const auto ask = [&](ObjectAddress object, std::string_view what) {
      if (!units_->has(object)) return;
      requests.push_back({.node = node_, .object = object});
      names.push_back(what);
    };
    ask(objects::kDigitalInputs, "inputs");
    for (const auto& shown : kShown) ask(shown.object, shown.what);
    const auto answers = session_->transfer(requests);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers[i] && answers[i].error().code != Errc::sdo_abort) return fail(answers[i].error());
      if (!answers[i]) continue;
      if (requests[i].object == objects::kDigitalInputs) {
        add_inputs(static_cast<std::uint32_t>(load_le(*answers[i])));
      } else if (const auto value = units_->physical(requests[i].object, *answers[i])) {
        if (value->value != 0 || requests[i].object == objects::kFollowingErrorWindow ||
            requests[i].object == objects::kSupplyVoltage)
          add(Weight::note, names[i], fmt::format("{} {}", number_text(value->value), value->unit));
      }
    }
    return {};
  }

  /// Limits are shown and do not stop: which motion they are in the way of is not known.
  void add_inputs(std::uint32_t word) {
    constexpr std::array<std::string_view, 3> kNames{"negative limit", "positive limit", "home switch"};
    const auto& rules = units_->profile().rules;
    std::string text;
    bool limit = false;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (!rules.motion.is_actuated(word, rules.motion.inputs[i])) continue;
      append(text, std::string(kNames[i]));
      limit = limit || i < 2;
    }
    if (text.empty()) text = "no limit, no home switch";
    if (rules.is_assumed("motion.inputs_active_low"))
      text += " (assumed: the manual does not state the active level)";
    add(limit ? Weight::caution : Weight::good, "inputs", fmt::format("60FDh is 0x{:08X}: {}", word, text));
  }

  /// The number a caution or a need depends on; empty where nothing tells it.
  Result<std::optional<double>> number(const std::string& name) {
    const auto object = units_->object(name);
    if (!object) return std::optional<double>();
    const auto answer = session_->upload(node_, *object);
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    if (!answer || answer->empty()) return std::optional<double>();
    const auto meaning = drive::fitted(units_->meaning(*object), answer->size());
    const auto value = od::decode(meaning.type, *answer);
    if (value && meaning.type_known) return std::optional(od::decode_number(meaning.encoding, *value));
    return std::optional(static_cast<double>(load_le(*answer)));
  }

  /// What has to be set before the drive listens to CANopen.
  Result<void> look_at_needs() {
    for (const auto& need : units_->profile().rules.nmt.needs) {
      const auto now = number(need.name);
      if (!now) return fail(now.error());
      if (*now && **now != static_cast<double>(need.value))
        add(Weight::caution, need.name,
            fmt::format("it is {}, and {} is needed for CANopen: the drive may not obey", **now, need.value));
    }
    return {};
  }

  static constexpr std::string_view kUnread = "{} cannot be read (check the panel): ";

  /// What cannot be read may hold.
  Result<void> look_at_cautions() {
    for (const auto& caution : units_->profile().rules.cautions) {
      std::string unread;
      if (caution.is_conditional()) {
        const auto now = number(caution.name);
        if (!now) return fail(now.error());
        if (*now && !caution.holds(**now)) continue;
        if (!*now)
          unread =
              fmt::format(fmt::runtime(chinese_ ? report::chinese_word(kUnread) : kUnread), caution.name);
      }
      add(Weight::caution, "",
          unread + (chinese_ && !caution.text_zh.empty() ? caution.text_zh : caution.text));
    }
    return {};
  }

  /// A drive that is simulated in this process is made from the same data: it proves nothing about them.
  void look_at_data() {
    const auto& url = session_->url();
    if (url.starts_with("sim:") || url.find(":sim:") != std::string::npos) return;
    add(Weight::note, "data",
        fmt::format("the drive data were checked against: {}",
                    drive::provenance_text(units_->profile(), chinese_)));
  }

  session::Session* session_;
  const MotionUnits* units_;
  std::uint8_t node_;
  bool chinese_;
  std::vector<PreflightItem> items_;
};

}  // namespace

std::string_view name(PreflightItem::Weight weight) {
  constexpr std::array<std::string_view, 4> kNames{"ok", "note", "caution", "stop"};
  return kNames[static_cast<std::size_t>(weight)];
}

Result<std::vector<PreflightItem>> preflight(session::Session& session, const MotionUnits& units,
                                             std::uint8_t node, bool chinese) {
  return Preflight(session, units, node, chinese).run();
}

PreflightItem watchdog_item(const WatchdogPlan& watchdog) {
  return {watchdog.stops() == Stops::yes ? Weight::good : Weight::caution, "watchdog", to_string(watchdog)};
}

Result<void> check_preflight(const std::vector<PreflightItem>& items, std::uint8_t node) {
  for (const auto& item : items)
    if (item.weight == Weight::stop)
      return fail(
          drive_error(Errc::refused, node, fmt::format("{}: {}", item.what, item.text), "nothing was moved"));
  return {};
}

}  // namespace servoctl::motion
