#pragma once

#include "drive/rules.hpp"
#include "drive/toml_reader.hpp"

/// The sections of a rules file, each with its keys.
namespace servoctl::drive {

Result<void> read_identity(const TableReader& reader, Rules& rules);
Result<void> read_units(const TableReader& reader, Rules& rules);
Result<void> read_sdo(const TableReader& reader, Rules& rules);
Result<void> read_nmt(const TableReader& reader, Rules& rules);
Result<void> read_pdo(const TableReader& reader, Rules& rules);
Result<void> read_coe(const TableReader& reader, Rules& rules);
Result<void> read_modbus(const TableReader& reader, Rules& rules);
Result<void> read_store(const TableReader& reader, Rules& rules);
Result<void> read_restart(const TableReader& reader, Rules& rules);
Result<void> read_mirror(const TableReader& reader, Rules& rules);
Result<void> read_statusword(const TableReader& reader, Rules& rules);
Result<void> read_quick_stop(const TableReader& reader, Rules& rules);
Result<void> read_motion(const TableReader& reader, Rules& rules);
Result<void> read_emergency(const TableReader& reader, Rules& rules);
Result<void> read_fault(const TableReader& reader, Rules& rules);
Result<void> read_numbering(const TableReader& reader, Numbering& out);
Result<void> read_caution(const TableReader& reader, Caution& out);

}  // namespace servoctl::drive
