#include "command/interface_option.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "can/link.hpp"
#include "session/open_bus.hpp"

namespace servoctl::command {

Result<std::string> interface_argument(const Arguments& arguments) {
  auto name = session::canonical_url(arguments.text("interface"));
  if (name.find(':') != std::string::npos)
    return fail(
        Errc::usage, message("{} is no CAN interface of the kernel", as_it_is(name)),
        name.starts_with("slcan:")
            ? "the bitrate of such an adapter stands behind the @ and is set when it is opened: `scan -b "
              "slcan:PORT@500k`"
            : "name one, such as can0; `bus status` lists them");
  return name;
}

Result<std::optional<std::uint32_t>> number_option(const Arguments& arguments, std::string_view name,
                                                   std::uint32_t least, std::uint32_t most) {
  if (!arguments.has(name)) return std::optional<std::uint32_t>();
  const auto number = parse_digits(arguments.text(name), 10);
  if (!number || *number < least || *number > most)
    return fail(Errc::usage, message("{}: '{}' is not a number from {} to {}", as_it_is(name),
                                     as_it_is(arguments.text(name)), least, most));
  return std::optional(static_cast<std::uint32_t>(*number));
}

Result<void> hold_energised(const Context& context, const std::string& name) {
  if (context.front_end == nullptr) return {};
  const auto nodes = context.front_end->energised_on(name);
  if (nodes.empty()) return {};
  return fail(
      Errc::refused,
      message("{} stays as it is: node {} was left energised over it, and could not be stopped any more",
              as_it_is(name), node_name(nodes.front())),
      message("`disable -n {}` first", node_name(nodes.front())));
}

std::string who_receives(const std::string& name) {
  const auto count = can::link_receivers(name);
  if (count == 0) return {};
  return formatted("{} program{} of this machine receive{} from {} now", count, count == 1 ? "" : "s",
                   count == 1 ? "s" : "", name);
}

}  // namespace servoctl::command
