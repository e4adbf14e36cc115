#pragma once

#include "drive/provenance.hpp"
#include "report/value.hpp"

namespace servoctl::show {

/// What the data of a family were checked against: `manual manual_zh simulator drives`.
report::Record provenance_record(const drive::Provenance& provenance);

}  // namespace servoctl::show
