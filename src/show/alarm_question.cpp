#include "show/alarm_question.hpp"

#include <string>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/access_alarms.hpp"
#include "session/wary.hpp"

namespace servoctl::show {
namespace {

/// Whether the family that the user named is not the one whose alarms the drive's numbers tell.
bool is_contradicted(const Desk& desk, std::uint8_t node) {
  const auto* known = desk.session->wary_of(node);
  const auto* named = desk.profile;
  return known != nullptr && named != nullptr && !named->is_generic() && !named->of_file &&
         named->family != known->family && !drive::has_access_alarms(named->rules);
}

}  // namespace

Result<void> confirm_alarms(const Desk& desk, std::span<session::SdoRequest> requests) {
  auto& session = *desk.session;
  if (session.options().checks_numbers) session::consider_before(session, requests);
  const auto alarm_of = [&](const session::SdoRequest& request) {
    return session::access_alarm(session, request.node, request.object);
  };
  std::string objects;
  const session::SdoRequest* first = nullptr;
  for (auto& request : requests) {
    if (alarm_of(request).empty() || is_contradicted(desk, request.node)) continue;
    request.despite_alarm = true;
    if (first == nullptr) first = &request;
    append(objects, formatted("{} of node {}", to_string(request.object), request.node));
  }
  if (first == nullptr) return {};
  return desk.confirm(
      formatted("Read {}? The data of {} have no such object, and a request for it raises the alarm {}.",
                objects, session.wary_of(first->node)->family, alarm_of(*first)));
}

Result<void> confirm_unlisted(const Desk& desk, std::uint8_t node, std::span<const drive::Target> targets) {
  const auto* known = desk.session->wary_of(node);
  // A cabinet file says what its drives have, and nobody is there to be asked.
  if (known == nullptr || desk.audience == nullptr) return {};
  std::string names;
  std::string_view alarm;
  for (const auto& target : targets) {
    const auto here = drive::possible_alarm(*known, target.address);
    // What certainly raises one is another question.
    if (here.empty() || !drive::access_alarm(*known, target.address).empty()) continue;
    alarm = here;
    append(names, target.unlisted.empty() ? to_string(target.address)
                                          : formatted("{} ({})", target.unlisted, to_string(target.address)));
  }
  if (names.empty()) return {};
  return desk.confirm(formatted(
      "Ask node {} for {}? The data of {} do not list it; if the drive does not have it, the request "
      "raises the alarm {}.",
      node, names, known->family, alarm));
}

}  // namespace servoctl::show
