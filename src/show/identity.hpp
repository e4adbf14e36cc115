#pragma once

#include <optional>
#include <span>
#include <string>

#include "report/value.hpp"
#include "session/scan.hpp"

namespace servoctl::show {

/// `gsd600?`, `gsd600`, `gsd600? or ts?`; empty when no family fits.
std::string guess_text(std::span<const session::Guess> guesses);

/// Nodes with their identity and the families that fit.
report::Table identity_table(std::span<const session::Identity> nodes,
                             std::span<const drive::Family> families);

/// What a file keeps of it: `device_type vendor_id product_code revision serial device_name hardware_version
/// software_version`, null where the drive does not tell.
report::Record identity_record(const session::Identity& identity);
/// The other way round; empty where a field is of another kind.
std::optional<session::Identity> identity_of(const report::Value& record, std::uint8_t node);

/// What speaks against two drives being of one kind, as far as both tell it: `its vendor (1018h:01)`; empty
/// when nothing does.
std::string other_kind(const session::Identity& one, const session::Identity& other);

}  // namespace servoctl::show
