#include "settings/own_cob_ids.hpp"

#include "drive/standard_objects.hpp"

namespace servoctl::settings {
namespace {

/// CAN-ID without the node-ID, in a COB-ID (CiA 301, 7.3.5).
constexpr std::uint64_t kNodePart = 0x7F;

}  // namespace

Result<session::Values> read_own_cob_ids(show::Desk& desk, std::uint8_t node) {
  std::vector<session::SdoRequest> requests;
  const auto add = [&](ObjectAddress object) {
    if (desk.profile->dictionary.find(object) != nullptr)
      requests.push_back({.node = node, .object = object});
  };
  add(objects::kEmergencyCobId);
  for (const std::uint16_t first : {std::uint16_t{0x1400}, std::uint16_t{0x1800}})
    for (std::uint16_t pdo = 0; pdo < 8; ++pdo) add({static_cast<std::uint16_t>(first + pdo), 1});
  const auto answers = desk.session->transfer(requests);
  session::Values out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i]) out.emplace(requests[i].object, *answers[i]);
    if (!answers[i] && answers[i].error().code != Errc::sdo_abort) return fail(answers[i].error());
  }
  return out;
}

std::vector<ObjectAddress> left_behind(std::uint8_t node, const session::Values& before,
                                       const session::Values& now) {
  std::vector<ObjectAddress> out;
  for (const auto& [object, data] : before) {
    const auto found = now.find(object);
    const bool of_node = (load_le(data) & kNodePart) == node;
    if (of_node && found != now.end() && found->second == data) out.push_back(object);
  }
  return out;
}

}  // namespace servoctl::settings
