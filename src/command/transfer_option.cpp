#include "command/transfer_option.hpp"

#include "base/format.hpp"

namespace servoctl::command {
namespace {

using canopen::Transfer;

/// The parser lets only the known words through.
Transfer given_transfer(const Arguments& arguments) {
  const auto word = arguments.text("--transfer");
  if (word == "expedited") return Transfer::expedited;
  if (word == "segmented") return Transfer::segmented;
  if (word == "block") return Transfer::block;
  return Transfer::automatic;
}

bool knows_block(const Context& context) {
  return context.profile == nullptr ||
         (context.profile->rules.sdo.segmented && context.profile->rules.sdo.block);
}

}  // namespace

Transfer read_transfer(const Context& context, const Arguments& arguments, bool large) {
  const auto given = given_transfer(arguments);
  return given == Transfer::automatic && large && knows_block(context) ? Transfer::domain : given;
}

Result<Transfer> write_transfer(const Context& context, const Arguments& arguments, std::size_t size) {
  const auto given = given_transfer(arguments);
  if (given == Transfer::expedited && (size == 0 || size > 4))
    return fail(Errc::usage, message("{} bytes cannot be sent expedited", size),
                "it takes 1 to 4 bytes; leave --transfer out");
  if (given != Transfer::automatic || size <= 4) return given;
  if (context.profile != nullptr && !context.profile->rules.sdo.segmented)
    return fail(
        Errc::usage,
        message("{} accepts at most 4 bytes per write, not {}", as_it_is(context.profile->family), size),
        "--transfer segmented or block tries it anyway");
  return knows_block(context) ? Transfer::automatic : Transfer::segmented;
}

}  // namespace servoctl::command
