#include "session/drive_units.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "drive/assumed_unit.hpp"
#include "drive/standard_objects.hpp"
#include "od/esi_unit.hpp"

namespace servoctl::session {
namespace {

using Unit = DriveUnits::Unit;

constexpr std::string_view kIncrement = "inc";
constexpr std::string_view kIncrementRate = "inc/s";

/// CiA 402-2: SI units, as codes of CiA 303-2, and the velocity factor.
constexpr ObjectAddress kSiUnitPosition{0x60A8, 0};
constexpr ObjectAddress kSiUnitVelocity{0x60A9, 0};
constexpr ObjectAddress kSiUnitAcceleration{0x60AA, 0};
constexpr ObjectAddress kVelocityFactorNumerator{0x6096, 1};
constexpr ObjectAddress kVelocityFactorDivisor{0x6096, 2};

/// The objects that name units, and those whose units they name: a drive may have only some of them.
constexpr ObjectAddress kPositions[] = {objects::kPositionActual, objects::kTargetPosition};
constexpr ObjectAddress kSpeeds[] = {objects::kTargetVelocity, objects::kVelocityActual,
                                     objects::kProfileVelocity, objects::kHomingSpeedSwitch};
constexpr ObjectAddress kAccelerations[] = {objects::kProfileAcceleration, objects::kProfileDeceleration,
                                            objects::kHomingAcceleration};
struct Row {
  std::span<const ObjectAddress> of;
  ObjectAddress named_by;
};
constexpr Row kRows[] = {{kPositions, kSiUnitPosition},
                         {kSpeeds, kSiUnitVelocity},
                         {kAccelerations, kSiUnitAcceleration},
                         {kSpeeds, kVelocityFactorNumerator},
                         {kSpeeds, kVelocityFactorDivisor}};

bool is_any_assumed(const drive::Profile& profile, std::span<const ObjectAddress> objects) {
  return std::any_of(objects.begin(), objects.end(), [&](ObjectAddress object) {
    return drive::is_unit_assumed(drive::target_at(&profile, object));
  });
}

std::optional<Unit> unit_of(const std::optional<Bytes>& answer) {
  if (!answer || answer->size() != 4) return std::nullopt;
  const auto unit = od::si_unit(static_cast<std::uint32_t>(load_le(*answer)));
  return unit ? std::optional(Unit{unit->unit, unit->scale}) : std::nullopt;
}

/// Units of speed in one unit of position a second, where 6096h was set: as it is delivered, 1 : 1, it says
/// nothing.
std::optional<double> factor_of(const std::optional<Bytes>& numerator, const std::optional<Bytes>& divisor) {
  if (!numerator || !divisor) return std::nullopt;
  const auto above = static_cast<double>(load_le(*numerator));
  const auto below = static_cast<double>(load_le(*divisor));
  return above > 0 && below > 0 && above != below ? std::optional(above / below) : std::nullopt;
}

}  // namespace

DriveUnits::DriveUnits(Session& session, const drive::Profile& profile, std::uint8_t node) {
  std::vector<SdoRequest> requests;
  for (const auto& row : kRows)
    if (is_any_assumed(profile, row.of) && profile.dictionary.find(row.named_by) != nullptr)
      requests.push_back({.node = node, .object = row.named_by});
  const auto answers = session.transfer(requests);
  const auto answer = [&](ObjectAddress object) -> std::optional<Bytes> {
    for (std::size_t i = 0; i < requests.size(); ++i)
      if (requests[i].object == object && answers[i]) return *answers[i];
    return std::nullopt;
  };
  for (const auto& one : answers)
    if (!one && one.error().code != Errc::sdo_abort) unanswered_ = one.error();
  position_ = unit_of(answer(kSiUnitPosition));
  velocity_ = unit_of(answer(kSiUnitVelocity));
  acceleration_ = unit_of(answer(kSiUnitAcceleration));
  const auto factor = factor_of(answer(kVelocityFactorNumerator), answer(kVelocityFactorDivisor));
  if (!factor) return;
  // A unit of position a second and a factor that makes another one of it contradict each other.
  if (velocity_ && velocity_->name == kIncrementRate)
    velocity_.reset();
  else if (!velocity_ && position_ && position_->name == kIncrement)
    velocity_ = Unit{std::string(kIncrementRate), 1 / *factor};
}

void DriveUnits::prove_position() {
  if (!position_) position_ = Unit{std::string(kIncrement), 1};
}

const std::optional<Unit>& DriveUnits::of(const drive::Target& target) const {
  if (target.entry->unit == kIncrement) return position_;
  return target.entry->unit == kIncrementRate ? velocity_ : acceleration_;
}

bool DriveUnits::proves(const drive::Target& target) const {
  return !drive::is_unit_assumed(target) || of(target).has_value();
}

void DriveUnits::apply(const drive::Target& target, drive::Meaning& meaning) const {
  if (!drive::is_unit_assumed(target)) return;
  const auto& own = of(target);
  meaning.unit = own ? std::string_view(own->name) : std::string_view();
  meaning.scale = own ? own->scale : 1;
  meaning.measure = drive::needed_measure(meaning.unit, target.address);
}

}  // namespace servoctl::session
