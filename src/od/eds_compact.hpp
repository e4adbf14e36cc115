#pragma once

#include "od/dictionary.hpp"
#include "od/eds_findings.hpp"
#include "od/eds_types.hpp"
#include "od/ini.hpp"

namespace servoctl::od {

/// `[xxxxName]`, `[xxxxValue]`, `[xxxxDenotation]`: lists of `sub=text`, sub decimal; null where there is
/// none.
struct CompactLists {
  const IniSection* names = nullptr;
  const IniSection* values = nullptr;
  const IniSection* denotations = nullptr;
  std::uint64_t most = 254;  ///< Entries that may be made; fewer when the file asked for very many.
};

bool has_compact_subs(const IniSection& section);

/// CompactSubObj=N: sub 0 and N entries like the object, with names and (DCF) values from the lists (CiA
/// 306-1, 4.6.3.3); N of 255 is 254, told. Told as an error when N is above `lists.most`. Entries the object
/// has already stay. Denotations go to `notes`.
void add_compact_subs(const IniSection& section, const CompactLists& lists, const LimitTypes& types,
                      Object& object, std::vector<EntryNote>& notes, Findings& findings);

/// CompactPDO: the communication and mapping objects of PDOs the file counts (NrOfRXPDO, NrOfTXPDO) and does
/// not list. Bits 0 to 5 say which of sub 1 to 6 the communication objects have (CiA 306-1, 4.5.3).
void add_compact_pdos(const IniSection& device_info, Dictionary& dictionary, Findings& findings);

}  // namespace servoctl::od
