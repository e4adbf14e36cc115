#include "settings/setting_line.hpp"

#include <fmt/format.h>

namespace servoctl::settings {

tl::unexpected<Error> writes_no_value(std::string_view command) {
  return fail(Errc::file, fmt::format("'{}' writes no value", command),
              "to be read as settings, a batch file holds `param set` and `write` lines");
}

}  // namespace servoctl::settings
