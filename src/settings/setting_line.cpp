#include "settings/setting_line.hpp"

#include "base/format.hpp"

namespace servoctl::settings {

tl::unexpected<Error> writes_no_value(std::string_view command) {
  return fail(Errc::file, message("'{}' writes no value", as_it_is(command)),
              "a batch file read as settings may only contain `param set` and `write`");
}

}  // namespace servoctl::settings
