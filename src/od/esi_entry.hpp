#pragma once

#include "od/dictionary.hpp"
#include "od/esi_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// Access, mapping, and what restricts them, from the Flags of an entry; of the object where the entry has
/// none. Without access it is read only, which is told: what is not known to be writable is not written.
void read_esi_flags(XmlElement own, XmlElement of_object, Entry& entry, EsiFindings& findings);

/// Unit and comments of an entry, from its Info and from the element that describes it.
void read_esi_remarks(XmlElement element, XmlElement info, Entry& entry);

}  // namespace servoctl::od
