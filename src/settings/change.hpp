#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "session/write.hpp"
#include "show/desk.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::settings {

/// One value that a user wants in one object.
struct Change {
  std::uint8_t node = 0;
  drive::Target target;
  od::DataType type = od::DataType::u32;
  Bytes data;
  canopen::Transfer transfer = canopen::Transfer::automatic;
  std::optional<drive::Bridge> bridge = {};  ///< What the drive's own measures say of the unit.
  bool type_given = false;                   ///< The user said the type: its size is not to be changed.
  std::optional<Bytes> before = {};  ///< What the drive held just before the write, where it was read.
  bool unchanged = false;            ///< The drive holds the value already: nothing is written.
};

/// Name of the object for a message that tells its address beside it: its label, else its address.
std::string name_of(const drive::Target& target);

/// The meaning of an object that holds these bytes, where the dictionary does not tell its type or its
/// length; nothing when no type has that length.
std::optional<drive::Meaning> learned_meaning(std::uint8_t node, const drive::Target& target,
                                              const drive::Meaning& meaning, const Bytes& bytes);

/// Turns a name and a value into a change. Errc::usage for an unknown name, a read-only object, a value that
/// does not fit; an object of unknown type is read first to learn its size.
Result<Change> make_change(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                           std::string_view value, std::optional<od::DataType> type);

/// Whether make_change() would accept the value, judged by the dictionary alone.
Result<void> check_change(const show::Desk& desk, std::uint8_t node, const drive::Target& target,
                          std::string_view value, std::optional<od::DataType> type);

/// Asks before changes that do more than change a value: store or restore commands, node-ID, bitrate.
Result<void> confirm_changes(show::Desk& desk, std::span<const Change> changes);

/// The frames of these changes, in the order they would be sent; on EtherCAT the values.
report::Value planned_frames(show::Desk& desk, std::span<const Change> changes);

/// What is to be done beside writing.
struct WriteOptions {
  bool read_back = false;
  bool keep = false;         ///< Make the values survive power-off, by the family's way.
  bool unlock = false;       ///< Give the family's password before, and take it back after.
  bool leave_equal = false;  ///< Read first, and do not write what the drive holds already.
};

/// What write_changes() would send: the values, and what the family's password and memory need around them.
/// Only reads. Errors as there.
Result<report::Value> planned_changes(show::Desk& desk, std::span<const Change> changes,
                                      const WriteOptions& options);

/// Writes the changes and reports for each: written, read back, kept, when it takes effect. Failures go to
/// `desk.errors`.
Result<report::Value> write_changes(show::Desk& desk, std::span<const Change> changes,
                                    const WriteOptions& options);

}  // namespace servoctl::settings
