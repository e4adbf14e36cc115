#include "settings/setting_line.hpp"

#include <fmt/format.h>

namespace servoctl::settings {

tl::unexpected<Error> writes_no_value(std::string_view command) {
  return fail(Errc::file, fmt::format("'{}' writes no value", command),
              "a batch file read as settings may only contain `param set` and `write`");
}

}  // namespace servoctl::settings
