#pragma once

#include "od/esi.hpp"
#include "od/esi_findings.hpp"
#include "od/esi_objects.hpp"

namespace servoctl::od {

/// Tells 1000h and 1018h where they are missing, PDO entries of objects the dictionary does not have or of
/// another length, PDOs whose default assignment is not as long as the sync manager's default size, and
/// mailboxes whose size is out of their own bounds.
void check_esi_layout(const EsiFile& file, const BitSizes& sizes, bool has_dictionary, Findings& findings);

/// Holds 1018h against the device's own numbers. EtherCAT masters know a device by these, so they are taken
/// where the two differ, which is told.
void settle_esi_identity(EsiFile& file, Findings& findings);

}  // namespace servoctl::od
