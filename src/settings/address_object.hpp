#pragma once

#include <string_view>

#include "drive/profile.hpp"
#include "show/desk.hpp"

/// The object of the node-ID of a drive whose data name none: the user does.
namespace servoctl::settings {

/// The family with this object for its node-ID. Errc::refused where its data name another one; Errc::usage as
/// drive::resolve().
Result<drive::Profile> with_address_object(const drive::Profile& profile, std::string_view object);

/// Errc::refused where that object does not hold the node-ID of the node: it may be any other setting. A
/// notice says that nothing tells when it takes effect.
Result<void> check_address_object(show::Desk& desk, const drive::Profile& profile);

}  // namespace servoctl::settings
