#pragma once

#include <cstddef>
#include <map>

#include "od/dictionary.hpp"
#include "od/esi_findings.hpp"
#include "od/xml.hpp"

namespace servoctl::od {

/// Bits of entries whose type is not whole bytes, as `BIT3`: what a mapping gives them.
using BitSizes = std::map<ObjectAddress, std::size_t>;

/// Takes the objects of a Dictionary element into `dictionary`, with types, names in two languages, access,
/// limits, defaults and labels. What is wrong is told, and left out.
void read_esi_objects(XmlElement element, Dictionary& dictionary, BitSizes& sizes, EsiFindings& findings);

}  // namespace servoctl::od
