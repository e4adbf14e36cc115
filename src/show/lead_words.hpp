#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "show/topic_query.hpp"

namespace servoctl::show {

/// What is typed behind a word that says what it is: `abort 06090030`, `EMCY 0x8130`, `故障码 AL.09`.
struct Led {
  Found found = Found::abort;  ///< Object, parameter, fault or abort.
  std::string rest;            ///< Without the word; never empty.
};

/// Messages of servoctl, of drives and of manuals put such words before a code, and people type both. Empty
/// where none begins the text, or nothing is behind it.
std::optional<Led> without_lead(std::string_view text);

}  // namespace servoctl::show
