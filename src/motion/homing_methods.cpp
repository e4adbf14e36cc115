#include "motion/homing_methods.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::motion {
namespace {

/// Methods are numbers of 8 bits; more entries than that say nothing.
constexpr std::size_t kMostMethods = 254;

/// They are signed, in 8 or 16 bits.
std::int64_t method_of(const Bytes& bytes) {
  const auto raw = load_le(bytes);
  return bytes.size() == 1 ? static_cast<std::int8_t>(raw) : static_cast<std::int16_t>(raw);
}

}  // namespace

Result<std::vector<std::int64_t>> supported_homing(session::Session& session, const drive::Profile& profile,
                                                   std::uint8_t node) {
  std::vector<std::int64_t> out;
  const auto* object = profile.dictionary.object(objects::kSupportedHomingIndex);
  if (object == nullptr || object->entries.size() < 2) return out;
  const auto count = session.upload(node, {objects::kSupportedHomingIndex, 0});
  if (!count && count.error().code != Errc::sdo_abort) return fail(count.error());
  if (!count) return out;
  const auto number = std::min<std::uint64_t>(load_le(*count), kMostMethods);
  std::vector<session::SdoRequest> requests;
  for (std::uint64_t sub = 1; sub <= number; ++sub)
    requests.push_back(
        {.node = node, .object = {objects::kSupportedHomingIndex, static_cast<std::uint8_t>(sub)}});
  for (const auto& answer : session.transfer(requests)) {
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    // 0 is no method: an entry that is not used.
    if (answer && !answer->empty() && method_of(*answer) != 0) out.push_back(method_of(*answer));
  }
  return out;
}

Result<void> check_homing(const std::vector<std::int64_t>& supported, std::int64_t method,
                          std::uint8_t node) {
  if (supported.empty() || std::find(supported.begin(), supported.end(), method) != supported.end())
    return {};
  return fail(drive_error(Errc::refused, node, message("the drive does not support homing method {}", method),
                          message("its methods by 0x60E3: {}", fmt::join(supported, ", "))));
}

}  // namespace servoctl::motion
