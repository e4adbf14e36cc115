#pragma once

#include "od/dictionary.hpp"
#include "od/eds_findings.hpp"
#include "od/eds_lists.hpp"

namespace servoctl::od {

/// Tells 1000h, 1001h and 1018h where they are missing: every device has them (CiA 301, 7.5.1).
void check_mandatory_objects(const PresentObjects& present, Findings& findings);

/// Tells PDO mappings, by default and as configured, of objects the file does not have, of a length that is
/// not the object's, and of more than 64 bits together (CiA 301, 7.5.2.36).
void check_mappings(const Dictionary& dictionary, Findings& findings);

}  // namespace servoctl::od
