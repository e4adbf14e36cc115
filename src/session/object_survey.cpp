#include "session/object_survey.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

/// Few enough that little is asked after an alarm, and that silence costs little.
constexpr std::size_t kAtOnce = 16;

std::vector<canopen::Emergency> emergencies_of(Session& session, std::uint8_t node) {
  const auto& heard = session.watch().emergencies(node);
  return {heard.begin(), heard.end()};
}

bool is_of_one_object(const Error& error) {
  return error.code == Errc::sdo_abort || error.code == Errc::protocol;
}

}  // namespace

ObjectSurvey::ObjectSurvey(Session& session, std::uint8_t node, OnAlarm on_alarm)
    : session_(&session), node_(node), on_alarm_(on_alarm), heard_(emergencies_of(session, node)) {}

Result<std::vector<Result<Bytes>>> ObjectSurvey::read(std::span<const ObjectAddress> objects) {
  std::vector<Result<Bytes>> out;
  while (out.size() < objects.size()) {
    const auto part = objects.subspan(out.size(), std::min(kAtOnce, objects.size() - out.size()));
    auto answers = ask(part);
    if (const auto taken = take(answers, part, out); !taken) return fail(taken.error());
    if (const auto quiet = check_alarms(part.back()); !quiet) return fail(quiet.error());
  }
  return out;
}

std::vector<Result<Bytes>> ObjectSurvey::ask(std::span<const ObjectAddress> objects) {
  std::vector<SdoRequest> requests;
  for (const auto object : objects)
    requests.push_back({.node = node_, .object = object, .despite_alarm = on_alarm_ == OnAlarm::go_on});
  return session_->transfer(requests);
}

/// What follows a read without an answer was not sent: it is asked for again if the node still answers, and
/// so is what came late.
Result<void> ObjectSurvey::take(std::vector<Result<Bytes>>& answers, std::span<const ObjectAddress> objects,
                                std::vector<Result<Bytes>>& out) {
  for (std::size_t i = 0; i < answers.size(); ++i) {
    ++requests_;
    auto& answer = answers[i];
    const bool is_silent = !answer && answer.error().code == Errc::timeout;
    if (is_silent) {
      if (const auto alive = check_alive(answer.error()); !alive) return alive;
      answer = std::move(ask(objects.subspan(i, 1)).front());
    }
    if (!answer && !is_of_one_object(answer.error()) && answer.error().code != Errc::timeout)
      return fail(answer.error());
    out.push_back(std::move(answer));
    if (is_silent) return {};
  }
  return {};
}

Result<void> ObjectSurvey::check_alive(const Error& silence) {
  const auto type = session_->upload(node_, objects::kDeviceType);
  if (type || type.error().code == Errc::sdo_abort) return {};
  return fail(type.error().code == Errc::timeout ? silence : type.error());
}

Result<void> ObjectSurvey::check_alarms(ObjectAddress last) {
  auto now = emergencies_of(*session_, node_);
  const bool is_new = !now.empty() && now != heard_ && !now.back().is_reset();
  heard_ = std::move(now);
  if (!is_new || on_alarm_ == OnAlarm::go_on) return {};
  return fail(
      drive_error(Errc::refused, node_,
                  formatted("it sent the EMCY {:04X}h during the reads up to {}; nothing more is read",
                            heard_.back().code, to_string(last)),
                  "`status` and `fault show` tell whether the drive is in a fault"));
}

}  // namespace servoctl::session
