#include "command/type_option.hpp"

#include <string>
#include <vector>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"

namespace servoctl::command {

Result<std::optional<od::DataType>> parse_type_option(const Arguments& arguments) {
  if (!arguments.has("--type")) return std::optional<od::DataType>();
  const auto text = lower(arguments.text("--type"));
  if (const auto type = od::parse_data_type(text)) return std::optional(*type);
  const std::vector<std::string> names(std::begin(kTypeNames), std::end(kTypeNames));
  return fail(Errc::usage, message("'{}' is not a data type", as_it_is(text)),
              message("write {}", one_of(names)));
}

}  // namespace servoctl::command
