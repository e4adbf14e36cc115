#pragma once

#include <span>
#include <string>

#include "can/link.hpp"
#include "report/value.hpp"

namespace servoctl::show {

/// An interface as the kernel tells it.
struct NamedLink {
  std::string name;
  can::LinkState state;
};

/// All that is known of one interface: of its controller, of its traffic, of its adapter, and whether this
/// user may change it.
report::Record link_record(const std::string& name, const can::LinkState& state);

/// One row for each interface; JSON has the whole record of each.
report::Table link_table(std::span<const NamedLink> links);

}  // namespace servoctl::show
