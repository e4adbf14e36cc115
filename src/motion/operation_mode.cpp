#include "motion/operation_mode.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_needs.hpp"
#include "motion/power.hpp"
#include "session/fitting_size.hpp"

namespace servoctl::motion {
namespace {

constexpr Duration kModePatience = std::chrono::seconds(1);
constexpr Duration kModePause = std::chrono::milliseconds(5);

std::string known_modes(const drive::Meaning& meaning) {
  std::string out;
  for (const auto& label : *meaning.labels) append(out, formatted("{} {}", label.value, label.label));
  return out;
}

}  // namespace

std::string mode_text(const drive::Profile& profile, std::int8_t mode, bool chinese) {
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeDisplay), 0);
  const auto* label = drive::label_of(meaning, od::Value(std::int64_t{mode}));
  if (label == nullptr) return mode == 0 ? std::string("0 none") : formatted("{}", mode);
  return formatted("{} {}", mode, chinese && !label->label_zh.empty() ? label->label_zh : label->label);
}

bool is_unknown_maker_mode(const drive::Profile& profile, std::int8_t mode) {
  if (mode >= 0 || !profile.is_generic()) return false;
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeOfOperation), 0);
  return drive::label_of(meaning, od::Value(std::int64_t{mode})) == nullptr;
}

Result<std::int8_t> read_mode(session::Session& session, std::uint8_t node) {
  const auto answer = session.upload(node, objects::kModeDisplay);
  if (!answer) return fail(answer.error());
  return static_cast<std::int8_t>(load_le(*answer));
}

Result<void> check_mode(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                        std::int8_t mode) {
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeOfOperation), node);
  if (is_unknown_maker_mode(profile, mode)) return {};
  if (meaning.labels != nullptr && drive::label_of(meaning, od::Value(std::int64_t{mode})) == nullptr)
    return fail(drive_error(Errc::refused, node, message("{} has no mode {}", as_it_is(profile.family), mode),
                            "modes: " + known_modes(meaning)));
  if (mode < 1 || mode > 32) return {};
  const auto modes = supported_modes(session, profile, node);
  if (!modes) return fail(modes.error());
  if (supports(*modes, mode)) return {};
  auto hint = possible_motions(profile, *modes);
  return fail(drive_error(
      Errc::refused, node,
      message("the drive does not support mode {} (0x6502 is 0x{:X})", mode_text(profile, mode), *modes),
      hint.empty() ? "0x6502 lists its modes: bit 0 is mode 1" : std::move(hint)));
}

session::SdoRequest mode_write(const drive::Profile& profile, std::uint8_t node, std::int8_t mode) {
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeOfOperation), node);
  const auto size = meaning.type_known ? od::size_of(meaning.type).value_or(1) : 1;
  const auto raw = static_cast<std::uint64_t>(static_cast<std::int64_t>(mode));
  return {node, objects::kModeOfOperation, store_le(raw, size)};
}

Result<void> set_mode(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                      std::int8_t mode) {
  const auto write = mode_write(profile, node, mode);
  const auto written = session::download_in_size(session, node, write.object, *write.data, od::DataType::i8);
  if (!written) return written;
  const auto end = session.now() + kModePatience;
  for (;;) {
    const auto now_in = read_mode(session, node);
    if (!now_in) return fail(now_in.error());
    if (*now_in == mode) return {};
    if (session.now() >= end)
      return fail(drive_error(Errc::negative, node,
                              message("was set to mode {} but stays in mode {} (6061h)",
                                      mode_text(profile, mode), mode_text(profile, *now_in)),
                              "is it in the control mode for CANopen motion? `info` names what it needs"));
    if (const auto paused = pause(session, kModePause); !paused) return paused;
  }
}

}  // namespace servoctl::motion
