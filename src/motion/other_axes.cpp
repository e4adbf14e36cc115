#include "motion/other_axes.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "session/addressing.hpp"

namespace servoctl::motion {
namespace {

constexpr Duration kAxisPause = std::chrono::milliseconds(5);

std::optional<std::uint16_t> word_in(const Result<Bytes>& answer) {
  return answer ? std::optional(static_cast<std::uint16_t>(load_le(*answer))) : std::nullopt;
}

/// Those that the family's dictionary has.
std::vector<OtherAxis> listed_axes(session::Session& session, const drive::Profile& profile,
                                   std::uint8_t node) {
  std::vector<OtherAxis> out;
  for (unsigned number = 2; number <= drive::kMostAxes; ++number) {
    OtherAxis axis{number, {}};
    if (profile.dictionary.find(axis.statusword_object()) == nullptr) continue;
    axis.statusword = word_in(session.upload(node, axis.statusword_object()));
    out.push_back(axis);
  }
  return out;
}

}  // namespace

ObjectAddress OtherAxis::statusword_object() const { return drive::of_axis(objects::kStatusword, number); }
ObjectAddress OtherAxis::controlword_object() const { return drive::of_axis(objects::kControlword, number); }

bool OtherAxis::may_be_energised() const {
  return !statusword || drive::is_energised(drive::decode_state(*statusword));
}

std::string OtherAxis::text() const {
  const auto object = to_string(statusword_object());
  return statusword ? formatted("axis {} ({}) is in {}", number, object,
                                drive::name(drive::decode_state(*statusword)))
                    : formatted("axis {} ({}) does not tell its state", number, object);
}

std::vector<OtherAxis> other_axes(session::Session& session, const drive::Profile* profile,
                                  std::uint8_t node) {
  if (profile != nullptr && !profile->is_generic()) return listed_axes(session, *profile, node);
  std::vector<OtherAxis> out;
  // One that is silent about what it lacks has no axes behind that.
  for (const auto& axis : session::further_axes(session, node).axes)
    out.push_back({axis.number, axis.statusword});
  return out;
}

std::string axes_text(const std::vector<OtherAxis>& others, bool has_first) {
  std::string states;
  for (const auto& axis : others) append(states, axis.text(), "; ");
  if (!has_first)
    return formatted(
        "it has no axis 1 ({}), which servoctl commands; {}; `read` and `write` reach its objects",
        to_string(objects::kStatusword), states);
  return formatted("the device has {} axes; this is about axis 1 ({}) only; {}", others.size() + 1,
                   to_string(objects::kStatusword), states);
}

Result<void> stop_axes(session::Session& session, std::uint8_t node, std::vector<OtherAxis>& axes,
                       bool disable) {
  const auto say = [&](const OtherAxis& axis, std::uint16_t word) {
    (void)session.download(node, axis.controlword_object(), store_le(word, 2));
  };
  for (const auto& axis : axes) say(axis, disable ? kSwitchOffWord : kQuickStopWord);
  if (disable)
    for (const auto& axis : axes) say(axis, kDisableVoltageWord);
  Result<void> out;
  for (auto& axis : axes) {
    const auto end = session.now() + Power::kPatience;
    do {
      axis.statusword = word_in(session.upload(node, axis.statusword_object()));
    } while (axis.may_be_energised() && session.now() < end && pause(session, kAxisPause));
    const bool stands = !disable && axis.statusword &&
                        drive::decode_state(*axis.statusword) == drive::DriveState::quick_stop_active;
    if (out && axis.may_be_energised() && !stands)
      out = fail(drive_error(Errc::negative, node, message("{}: it may be energised", axis.text()),
                             "switch off the supply"));
  }
  return out;
}

}  // namespace servoctl::motion
