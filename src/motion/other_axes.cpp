#include "motion/other_axes.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"

namespace servoctl::motion {
namespace {

constexpr Duration kAxisPause = std::chrono::milliseconds(5);

bool is_asked(session::Session& session, std::uint8_t node) {
  const auto type = session.upload(node, objects::kDeviceType);
  return type && drive::is_drive_type(load_le(*type));
}

std::optional<std::uint16_t> read_word(session::Session& session, std::uint8_t node, const OtherAxis& axis) {
  const auto answer = session.upload(node, axis.statusword_object());
  return answer ? std::optional(static_cast<std::uint16_t>(load_le(*answer))) : std::nullopt;
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
  std::vector<OtherAxis> out;
  const bool is_known = profile != nullptr && !profile->is_generic();
  for (unsigned number = 2; number <= drive::kMostAxes; ++number) {
    OtherAxis axis{number, {}};
    if (is_known && profile->dictionary.find(axis.statusword_object()) == nullptr) break;
    if (!is_known && number == 2 && !is_asked(session, node)) break;
    axis.statusword = read_word(session, node, axis);
    if (!is_known && !axis.statusword) break;
    out.push_back(axis);
  }
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
      axis.statusword = read_word(session, node, axis);
    } while (axis.may_be_energised() && session.now() < end && pause(session, kAxisPause));
    const bool stands = !disable && axis.statusword &&
                        drive::decode_state(*axis.statusword) == drive::DriveState::quick_stop_active;
    if (out && axis.may_be_energised() && !stands)
      out = fail(drive_error(Errc::negative, node, formatted("{}: it may be energised", axis.text()),
                             "switch off the supply"));
  }
  return out;
}

}  // namespace servoctl::motion
