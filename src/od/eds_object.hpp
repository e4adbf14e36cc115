#pragma once

#include <span>
#include <utility>
#include <vector>

#include "od/dictionary.hpp"
#include "od/eds_compact.hpp"
#include "od/eds_findings.hpp"
#include "od/eds_section.hpp"
#include "od/eds_types.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// The sections of one object, each once.
struct ObjectSections {
  const IniSection* main = nullptr;
  std::vector<std::pair<std::uint8_t, const IniSection*>> subs;  ///< In rising sub-index.
};

/// Tells keys that appear twice in a section; IniSection::find takes the last.
void check_duplicate_keys(const IniSection& section, Findings& findings);

void tell_duplicate(const IniSection& again, const IniSection& first, Findings& findings);

/// Puts the sections of one index in order and tells what appears twice. Sub-indexes are hexadecimal (CiA
/// 306-1, 4.6.3). They are taken as decimal, with a warning, where the highest is then what sub 0 says; where
/// sub 0 says neither, when only decimal reading gives them without a gap.
ObjectSections group_sections(std::span<const ObjectSection> sections, Findings& findings);

/// The object that the sections describe, with its usable entries.
Object eds_object(std::uint16_t index, const ObjectSections& sections, const CompactLists& lists,
                  const LimitTypes& types, std::vector<EntryNote>& notes, Findings& findings);

}  // namespace servoctl::od
