#include "can/log_clock.hpp"

#include "base/format.hpp"

namespace servoctl::can {

std::string clock_text(const LogClock& clock, Duration time, char between) {
  using std::chrono::days;
  const auto wall = clock.zero + time;
  const auto day = std::chrono::floor<days>(wall);
  const auto micros = (wall - day).count();
  const auto of_day = formatted("{:02}:{:02}:{:02}.{:06}", micros / 3'600'000'000, micros / 60'000'000 % 60,
                                micros / 1'000'000 % 60, micros % 1'000'000);
  if (clock.kind == LogClock::Kind::day) return of_day;
  const std::chrono::year_month_day date{std::chrono::sys_days(day)};
  return formatted("{:04}-{:02}-{:02}{}{}{}", static_cast<int>(date.year()),
                   static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), between, of_day,
                   clock.kind == LogClock::Kind::utc ? "Z" : "");
}

}  // namespace servoctl::can
