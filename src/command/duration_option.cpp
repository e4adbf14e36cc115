#include "command/duration_option.hpp"

#include "base/duration.hpp"
#include "base/format.hpp"

namespace servoctl::command {

Result<std::optional<Duration>> duration_option(const Arguments& arguments, std::string_view name) {
  if (!arguments.has(name)) return std::optional<Duration>();
  auto time = read_duration(arguments.text(name));
  if (!time) {
    auto error = time.error();
    error.message = message("{}: {}", name, error.message);
    return fail(std::move(error));
  }
  if (*time == Duration::zero())
    return fail(Errc::usage, message("{}: '{}' is too short", name, as_it_is(arguments.text(name))),
                "write 500ms or 10s");
  return std::optional(*time);
}

}  // namespace servoctl::command
