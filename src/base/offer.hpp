#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/message.hpp"

/// What a hint offers in place of a word that is not known. The words stay as they are in every language.
namespace servoctl {

/// `did you mean a, b or c?`; empty when there is nothing to offer.
Message did_you_mean(std::string_view text, std::span<const std::string> candidates);

/// `a`, `a or b`, `a, b or c`.
Message one_of(std::span<const std::string> words);

}  // namespace servoctl
