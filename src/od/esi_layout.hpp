#pragma once

#include "od/esi.hpp"
#include "od/esi_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// Sync managers, FMMUs, PDOs, mailbox, synchronisation and EEPROM of a Device element.
EsiLayout read_esi_layout(XmlElement device, EsiFindings& findings);

/// Adds what PDOs tell of objects: that mapped ones can be mapped so; the mapping objects (1600h, 1A00h and
/// so on) and the assignments (1C12h, 1C13h) that the dictionary does not list; and where there is no
/// dictionary the mapped objects themselves.
void add_esi_pdos(const EsiLayout& layout, bool has_dictionary, Dictionary& dictionary);

}  // namespace servoctl::od
