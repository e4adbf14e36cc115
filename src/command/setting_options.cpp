#include "command/setting_options.hpp"

#include "base/format.hpp"

namespace servoctl::command {

Result<void> check_resume(const Arguments& arguments) {
  if (!arguments.has("--resume")) return {};
  for (const auto* option : {"--keep", "--unlock", "--force", "--with-address"})
    if (arguments.has(option))
      return fail(Errc::usage, message("--resume uses the original options, not {}", option),
                  message("leave {} away", option));
  return {};
}

}  // namespace servoctl::command
