#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"

namespace servoctl::sim {

/// Non-volatile memory of simulated drives, kept in a file when there is one. Drives are told apart by a key
/// that does not change with their node-ID: their place in the list and their family.
class Memory {
 public:
  using Cells = std::map<ObjectAddress, Bytes>;

  Memory() = default;

  /// Memory kept in `file`; an absent file is new memory. Errc::file when it is no file of this kind.
  static Result<Memory> open(const std::filesystem::path& file);

  /// The cells of one drive.
  Cells& cells(const std::string& drive) { return drives_[drive]; }

  /// Writes the file in one step; does nothing without one.
  Result<void> save() const;

 private:
  Result<void> parse(std::string_view text);

  std::filesystem::path file_;
  std::map<std::string, Cells> drives_;
};

}  // namespace servoctl::sim
