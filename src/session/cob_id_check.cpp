#include "session/cob_id_check.hpp"

#include <algorithm>

#include "canopen/cob_id_rules.hpp"

namespace servoctl::session {

Result<void> check_cob_id(const drive::Profile* profile, ObjectAddress object, ByteSpan data,
                          std::uint8_t node) {
  if (data.size() != 4) return {};
  auto cob_id = static_cast<std::uint32_t>(load_le(data));
  const auto* parameter = profile == nullptr ? nullptr : profile->parameter(object);
  if (parameter != nullptr && parameter->mirror) {
    const auto& with_node = profile->rules.mirror_add_node_id;
    object = *parameter->mirror;
    if (std::find(with_node.begin(), with_node.end(), object) != with_node.end()) cob_id += node;
  }
  const auto conflict = canopen::cob_id_conflict(object, cob_id, node);
  if (conflict.empty()) return {};
  return fail(Errc::usage, conflict,
              "CiA 301 reserves it for that service (7.3.5, table 40): not allowed here");
}

}  // namespace servoctl::session
