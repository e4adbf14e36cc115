#include "session/supervision.hpp"

#include "canopen/error_control.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

constexpr std::uint8_t kMostWatched = 127;

std::vector<ObjectAddress> objects_of_supervision(const drive::Profile& profile) {
  std::vector<ObjectAddress> out;
  const auto add = [&](ObjectAddress object) {
    if (profile.dictionary.find(object) != nullptr) out.push_back(object);
  };
  for (const auto object : {objects::kProducerHeartbeat, objects::kGuardTime, objects::kLifeTimeFactor,
                            objects::kAbortConnectionOption, objects::kCommunicationErrorBehaviour})
    add(object);
  for (std::uint8_t sub = 1; sub <= kMostWatched; ++sub) add({objects::kConsumerHeartbeatIndex, sub});
  if (const auto alarm = drive::place_of(profile, profile.rules.nmt.guarding_alarm)) out.push_back(*alarm);
  return out;
}

std::chrono::milliseconds ms_of(std::uint64_t value) { return std::chrono::milliseconds(value & 0xFFFFU); }

void take_in(Supervision& out, const drive::Profile& profile, ObjectAddress object, std::uint64_t value) {
  if (object == objects::kProducerHeartbeat) out.heartbeat = ms_of(value);
  if (object == objects::kGuardTime) out.guard_time = ms_of(value);
  if (object == objects::kLifeTimeFactor) out.life_time_factor = static_cast<std::uint8_t>(value);
  if (object == objects::kAbortConnectionOption) out.abort_option = static_cast<std::uint16_t>(value);
  if (object == objects::kCommunicationErrorBehaviour)
    out.communication_error = static_cast<std::uint8_t>(value);
  if (object == drive::place_of(profile, profile.rules.nmt.guarding_alarm)) out.guarding_alarm = value;
  if (object.index != objects::kConsumerHeartbeatIndex) return;
  const auto node = canopen::watched_node(static_cast<std::uint32_t>(value));
  out.entries.push_back({object.sub, node, node == 0 ? Duration{} : ms_of(value)});
}

}  // namespace

std::vector<Result<Supervision>> read_supervision(Session& session, const drive::Profile& profile,
                                                  std::span<const std::uint8_t> nodes) {
  const auto objects = objects_of_supervision(profile);
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    for (const auto object : objects) requests.push_back({.node = node, .object = object});
  const auto answers = session.transfer(requests);
  std::vector<Result<Supervision>> out;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Result<Supervision> one = Supervision{};
    one->node = nodes[i];
    for (std::size_t k = 0; one && k < objects.size(); ++k) {
      const auto& answer = answers[i * objects.size() + k];
      if (answer)
        take_in(*one, profile, objects[k], load_le(*answer));
      else if (answer.error().code != Errc::sdo_abort)
        one = fail(answer.error());
    }
    out.push_back(std::move(one));
  }
  return out;
}

std::uint32_t consumer_entry(std::uint8_t node, Duration time) {
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  if (node == 0 || count == 0) return 0;
  return static_cast<std::uint32_t>(node) << 16U | static_cast<std::uint32_t>(count);
}

}  // namespace servoctl::session
