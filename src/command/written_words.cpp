#include "command/written_words.hpp"

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "command/duration_option.hpp"

namespace servoctl::command {
namespace {

Result<void> check_time(const Command& command, const Parameter& parameter, const Arguments& arguments) {
  if (command.check == nullptr) {
    const auto time = duration_option(arguments, parameter.name);
    return time ? Result<void>() : fail(time.error());
  }
  const auto time = read_duration(arguments.text(parameter.name));
  if (time) return {};
  return fail(Errc::usage, message("{}: {}", parameter.name, time.error().message), time.error().hint);
}

}  // namespace

Result<void> check_written(const Command& command, const Arguments& arguments) {
  for (const auto& parameter : command.parameters) {
    if (!arguments.has(parameter.name)) continue;
    if (parameter.kind == Kind::duration)
      if (const auto time = check_time(command, parameter, arguments); !time) return time;
    if (parameter.kind != Kind::number) continue;
    for (const auto& text : arguments.all(parameter.name))
      if (!parse_integer(text) && !parse_real(text))
        return fail(Errc::usage, message("{}: '{}' is not a number", parameter.name, as_it_is(text)));
  }
  return {};
}

}  // namespace servoctl::command
