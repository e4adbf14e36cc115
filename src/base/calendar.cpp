#include "base/calendar.hpp"

#include <cstdlib>
#include <ctime>

#include "base/number.hpp"

namespace servoctl {

std::string utc_now_text() {
  const char* fixed = std::getenv("SOURCE_DATE_EPOCH");
  const auto seconds = fixed != nullptr ? parse_digits(fixed, 10) : std::nullopt;
  const auto time = seconds ? static_cast<std::time_t>(*seconds) : std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&time, &utc);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

}  // namespace servoctl
