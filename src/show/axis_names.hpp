#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/message.hpp"
#include "report/value.hpp"

namespace servoctl::show {

/// What the nodes of one bus are called in the cabinet: what is told of `node 3` is told of `feeder`.
class AxisNames {
 public:
  AxisNames() = default;
  explicit AxisNames(std::map<std::uint8_t, std::string> names) : names_(std::move(names)) {}

  bool empty() const { return names_.empty(); }
  /// Empty where the node has no name.
  std::string_view of(std::uint8_t node) const;
  /// A sentence with names for numbers: `node 3: no answer` is `feeder: no answer`, `nodes 3, 4` is
  /// `feeder, lift`, `-n 3` in a command is `-n feeder`. Nodes without a name stay numbers.
  std::string in(std::string_view text) const;
  /// Puts `axis` before every `node` of the records and tables of a result, and into an `axis` that is null.
  void put_into(report::Value& value) const;
  void put_into(report::Record& record) const;
  /// As in(), of the nodes in a message. What was put together elsewhere is looked through as a sentence is.
  void put_into(Message& message) const;
  /// The sentence with them.
  std::string sentence(Message message) const;

 private:
  std::map<std::uint8_t, std::string> names_;
};

}  // namespace servoctl::show
