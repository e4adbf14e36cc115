#include "show/live_view.hpp"

namespace servoctl::show {

std::optional<double> plotted(const report::Value& value) {
  const auto& data = value.data();
  if (const auto* i = std::get_if<std::int64_t>(&data)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&data)) return static_cast<double>(*u);
  if (const auto* d = std::get_if<double>(&data)) return *d;
  return std::nullopt;
}

}  // namespace servoctl::show
