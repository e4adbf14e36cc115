#pragma once

#include <string>
#include <string_view>

namespace servoctl::trial {

/// A heading of a report, or yes or no, in Chinese; the word itself where there is nothing to translate
/// (`TPDO1`, `603Fh`).
std::string heading_zh(std::string_view heading);

/// What a test is called in Chinese: `通信测试` of `comm`; empty for one that has no name.
std::string test_zh(std::string_view test);

}  // namespace servoctl::trial
