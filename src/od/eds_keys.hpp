#pragma once

#include "od/eds_findings.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// Gives misspelt keys of objects and of the device their right name (`DefaultVaule` → `DefaultValue`),
/// unless that one stands in the section as well; told either way. Keys of vendors that resemble none of CiA
/// 306 stay.
void mend_keys(IniText& ini, Findings& findings);
/// The same, told to nobody.
void mend_keys(IniText& ini);

}  // namespace servoctl::od
