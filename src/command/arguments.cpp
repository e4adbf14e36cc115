#include "command/arguments.hpp"

namespace servoctl::command {

std::string_view Arguments::text(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::string_view() : std::string_view(found->second.front());
}

std::span<const std::string> Arguments::all(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::span<const std::string>()
                                : std::span<const std::string>(found->second);
}

}  // namespace servoctl::command
