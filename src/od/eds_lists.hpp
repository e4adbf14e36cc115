#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "od/dictionary.hpp"
#include "od/eds_findings.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// The objects a file describes: those with sections (main may be null), in rising index, and those made of
/// counts.
struct PresentObjects {
  std::span<const std::pair<std::uint16_t, const IniSection*>> sections;
  const Dictionary& dictionary;

  bool has(std::uint64_t index) const;
};

/// Compares [MandatoryObjects], [OptionalObjects] and [ManufacturerObjects] with what there is: told is what
/// is listed and absent, listed twice, in the wrong list (CiA 306-1, 4.6.1), there and not listed, and wrong
/// counts.
void check_lists(std::span<const IniSection* const> lists, const PresentObjects& present, Findings& findings);

}  // namespace servoctl::od
