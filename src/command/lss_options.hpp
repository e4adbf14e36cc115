#pragma once

#include <functional>
#include <optional>
#include <string>

#include "canopen/lss.hpp"
#include "command/command.hpp"

/// What the commands of LSS have in common on the command line.
namespace servoctl::command {

inline constexpr Parameter kVendorOption{
    .name = "--vendor", .help = "vendor-ID of the slave (1018h:01), such as 0x319", .kind = Kind::number};
inline constexpr Parameter kProductOption{
    .name = "--product", .help = "its product code (1018h:02)", .kind = Kind::number};
inline constexpr Parameter kRevisionOption{
    .name = "--revision", .help = "its revision number (1018h:03)", .kind = Kind::number};
inline constexpr Parameter kSerialOption{
    .name = "--serial", .help = "its serial number (1018h:04)", .kind = Kind::number};
inline constexpr Parameter kOnlySlaveOption{
    .name = "--only", .help = "the only LSS slave on the bus, whoever it is", .kind = Kind::flag};

/// Which slave a line means: of this identity, or the only one.
struct LssChoice {
  std::optional<canopen::LssAddress> address;
};

/// All four numbers, --only, or -n of a node that tells them by SDO (1018h); where none of these is typed,
/// the slave that `lss select` chose on this bus, which is told, and without one the node of the prompt.
/// Errc::usage for none of these, for more than one, and for a part of an identity; else as
/// Session::upload().
Result<LssChoice> lss_choice(Context& context, const Arguments& arguments);
/// The same without the bus, for lines that are to be run later.
Result<void> check_lss_choice(const Context& context, const Arguments& arguments);

/// Selects the slave, asks what it is, and lets it go: `vendor_id product_code revision serial node
/// configured`. `found` is told who it is. Errors as LssDialogue::select().
Result<report::Value> look_at_lss_slave(Context& context, const LssChoice& choice,
                                        const std::function<void(const canopen::LssAddress&)>& found = {});

/// The number of an option, 0 to 2^32-1; empty when it was not given.
Result<std::optional<std::uint32_t>> lss_number(const Arguments& arguments, std::string_view name);

/// `vendor_id product_code revision serial` as in every other record of an identity.
report::Record lss_identity_record(const canopen::LssAddress& address);

/// What --dry-run shows: the frames of a selection, then those of each request, and that all go back to
/// waiting.
report::Value lss_planned_frames(const LssChoice& choice, std::span<const canopen::LssRequest> requests);

}  // namespace servoctl::command
