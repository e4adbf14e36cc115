#pragma once

#include <cstdint>
#include <map>

#include "drive/naming.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// What is known of objects where no family is named: those of CiA 301 are every node's, those of CiA 402
/// only a drive's, whose device type (1000h) is read once.
class StandardNames {
 public:
  explicit StandardNames(const Desk& desk) : desk_(&desk) {}

  /// The target with what the family says of it, else the standard; the address alone where neither does.
  drive::Target at(std::uint8_t node, ObjectAddress address);
  /// The same of one that was resolved.
  drive::Target named(std::uint8_t node, const drive::Target& target);

 private:
  bool is_drive(std::uint8_t node);

  const Desk* desk_;
  std::map<std::uint8_t, bool> drives_;
};

}  // namespace servoctl::show
