#pragma once

#include "drive/profile.hpp"
#include "report/catalogue.hpp"

namespace servoctl::show {

/// What the family calls its objects, parameters, values and faults in English, and in Chinese.
report::Names chinese_names(const drive::Profile& profile);

}  // namespace servoctl::show
