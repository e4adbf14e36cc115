#include "cabinet/axis_identity.hpp"

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/family_check.hpp"
#include "session/identify.hpp"
#include "session/wary.hpp"

namespace servoctl::cabinet {
namespace {

using session::FamilyVerdict;

tl::unexpected<Error> other_drive(const Axis& axis, ObjectAddress object, const Message& what, Message hint) {
  return fail(drive_error(Errc::refused, axis.node, object, what, std::move(hint)));
}

Result<void> hold_family(show::Desk& desk, const Axis& axis, std::span<const drive::Family> families) {
  const std::uint8_t nodes[] = {axis.node};
  const auto identity = session::identify(*desk.session, nodes, desk.profile->rules).front();
  if (!identity) return fail(identity.error());
  const auto verdict = session::judge_family(*identity, *desk.profile, families);
  if (verdict.kind == FamilyVerdict::Kind::contradicted)
    return other_drive(axis, verdict.object.value_or(objects::kDeviceType),
                       message("not a {}: {}", as_it_is(desk.profile->family), verdict.why),
                       "is another drive at this node, or is `family` wrong? `scan` shows who is there");
  if (verdict.kind == FamilyVerdict::Kind::unproven)
    desk.notices.push_back(message("node {}: nothing proves that it is a {}: {}", node_name(axis.node),
                                   as_it_is(desk.profile->family), verdict.why));
  session::be_wary_of_family(*desk.session, axis.node, *desk.profile);
  if (const auto heard = desk.session->listen(); !heard) return heard;
  return session::refuse_duplicate(*desk.session, axis.node);
}

}  // namespace

Result<session::Identity> hold_axis_identity(show::Desk& desk, const Axis& axis,
                                             std::span<const drive::Family> families) {
  if (const auto held = hold_family(desk, axis, families); !held) return fail(held.error());
  auto identity = session::read_identity(*desk.session, axis.node);
  if (!identity) return identity;
  if (const auto same = hold_serial(axis, *identity); !same) return fail(same.error());
  return identity;
}

Result<void> wait_for_second(show::Desk& desk, const Axis& axis) {
  if (desk.dry_run) return {};
  const std::uint8_t nodes[] = {axis.node};
  const auto heard = session::settle_duplicates(*desk.session, nodes, session::kBeforeMotion);
  if (const auto single = heard ? session::refuse_duplicate(*desk.session, axis.node) : heard; !single)
    return single;
  if (!axis.serial) return {};
  const auto identity = session::read_identity(*desk.session, axis.node);
  return identity ? hold_serial(axis, *identity) : fail(identity.error());
}

std::string serial_text(std::uint32_t serial) {
  return serial == 0 ? std::string("none") : formatted("{0} (0x{0:08X})", serial);
}

Result<void> hold_serial(const Axis& axis, const session::Identity& identity) {
  if (!axis.serial || identity.serial == axis.serial) return {};
  if (identity.serial.value_or(0) == 0)
    return other_drive(
        axis, objects::kSerialNumber,
        message("the drive tells no serial number, and the file says {}", serial_text(*axis.serial)),
        "remove `serial` where its drives tell none; was the drive replaced? `info` shows what it is");
  return other_drive(axis, objects::kSerialNumber,
                     message("the drive has the serial number {}, and the file says {}",
                             serial_text(*identity.serial), serial_text(*axis.serial)),
                     "was the drive replaced, or swapped with another? `info` shows what it is");
}

}  // namespace servoctl::cabinet
