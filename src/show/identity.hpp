#pragma once

#include <optional>
#include <span>
#include <string>

#include "report/value.hpp"
#include "session/scan.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// `gsd600?`, `gsd600`, `gsd600? or ts?`; empty when no family fits.
std::string guess_text(std::span<const session::Guess> guesses);

/// Of a drive, as far as it tells: 6041h and 603Fh.
struct Condition {
  std::optional<std::uint16_t> statusword;
  std::optional<std::uint16_t> fault;
};

/// The columns of a condition: state and fault in text, unless that has the identity (`in_full`); in JSON
/// state, statusword and fault.
void add_condition_columns(bool in_full, report::Table& table);
/// Its cells.
void add_condition(const Desk& desk, const Condition& condition, bool in_full, report::List& row);

/// Nodes with their identity, the families that fit, and how they are, in the same order. In text the
/// identity
/// (`in_full`) or the condition, for each of which a line of 80 columns has room; in JSON both.
report::Table identity_table(const Desk& desk, std::span<const session::Identity> nodes,
                             std::span<const Condition> conditions, std::span<const drive::Family> families,
                             bool in_full);

/// What a file keeps of it: `device_type vendor_id product_code revision serial device_name hardware_version
/// software_version`, null where the drive does not tell.
report::Record identity_record(const session::Identity& identity);
/// The other way round; empty where a field is of another kind.
std::optional<session::Identity> identity_of(const report::Value& record, std::uint8_t node);

/// What speaks against two drives being of one kind, as far as both tell it: `its vendor (1018h:01)`; empty
/// when nothing does.
std::string other_kind(const session::Identity& one, const session::Identity& other);

/// What a drive keeps of its identity for life: not its versions, nor its state.
session::Identity lasting(const session::Identity& identity);
/// In which of these a drive differs from what it was, such as `its serial number (1018h:04)`; empty when it
/// is the same one, as far as it tells.
std::string change_of(const session::Identity& before, const session::Identity& now);

/// For session::scan(): says which drives are asked for more than every drive has. Empty if the user named
/// the family.
session::BeforeDetails warn_of_details(const Desk& desk, std::span<const drive::Family> families);

}  // namespace servoctl::show
