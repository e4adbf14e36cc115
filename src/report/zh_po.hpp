#pragma once

#include <string_view>

namespace servoctl::report {

/// The file src/report/zh.po, as it was when the program was built.
std::string_view zh_po();

}  // namespace servoctl::report
