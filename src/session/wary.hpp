#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "base/object_address.hpp"
#include "drive/standard_objects.hpp"
#include "session/identity.hpp"
#include "session/session.hpp"

/// Drives that raise an alarm when they are asked for an object that they do not have
/// (drive::access_alarm()). If a node may be such a drive, Session::transfer() does not send these requests
/// and answers them itself.
namespace servoctl::session {

/// What decides whether a drive may be asked for every object.
inline constexpr std::array<ObjectAddress, 3> kDecidingNumbers{objects::kDeviceType, objects::kVendorId,
                                                               objects::kProductCode};

/// Decides by 1000h and 1018h: if they agree with a family that has access alarms, Session::be_wary() of it;
/// otherwise the node is asked for everything.
void consider_numbers(Session& session, const Identity& numbers);

/// Reads 1000h, 1018h:01 and 1018h:02 of the nodes that were not considered since their boot-up, and decides.
/// Nodes that answer none of them are left as they are.
void consider_numbers(Session& session, std::span<const std::uint8_t> nodes);

/// The same, of the nodes that a request could raise an alarm on: the data of some family with access alarms
/// lack its object, and no family is known for the node (Options::checks_numbers).
void consider_before(Session& session, std::span<const SdoRequest> requests);

/// Session::be_wary() of the family that the user named, if it has access alarms. If it is a file of the
/// user's own, its objects decide.
void be_wary_of_family(Session& session, std::uint8_t node, const drive::Profile& profile);

/// The alarm that this request would raise on the node, as its panel shows it; empty: none is known.
std::string_view access_alarm(const Session& session, std::uint8_t node, ObjectAddress object);

/// The result of a request that was not sent because of access_alarm(): Errc::sdo_abort with the abort code
/// that a drive without the object gives. Empty: the object may be asked for.
std::optional<Error> refusal_of(const Session& session, std::uint8_t node, ObjectAddress object);

}  // namespace servoctl::session
