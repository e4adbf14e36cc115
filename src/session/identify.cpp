#include "session/identify.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "drive/shared_profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"
#include "session/can_network.hpp"
#include "session/family_check.hpp"
#include "session/wary.hpp"

namespace servoctl::session {
namespace {

/// For one that answers twice, however slow the second is.
constexpr Duration kMostPatience = std::chrono::seconds(1);

/// A node that refuses a read is there; one that does not answer, or is not reached, is not known.
bool tells(const Result<Bytes>& answer) {
  return answer || answer.error().code == Errc::sdo_abort || answer.error().code == Errc::protocol;
}

Result<void> listen_until(Session& session, TimePoint end) {
  if (const auto waited = session.wait([] { return false; }, end); !waited) return fail(waited.error());
  return session.listen();  // What came before, too, where the end is past.
}

/// What decides what a drive may be asked for: 1000h, 1018h:01 and :02; with 1018h:03 where it is wanted. A
/// node that does not answer has an error.
std::vector<Result<Identity>> read_numbers(Session& session, std::span<const std::uint8_t> nodes,
                                           bool with_revision) {
  std::vector<ObjectAddress> objects{objects::kDeviceType, objects::kVendorId, objects::kProductCode};
  if (with_revision) objects.push_back(objects::kRevision);
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    for (const auto object : objects) requests.push_back({node, object, {}});
  const auto answers = session.transfer(requests);
  std::vector<Result<Identity>> out;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto here = std::span(answers).subspan(i * objects.size(), objects.size());
    const auto silent = std::find_if(here.begin(), here.end(), [](const auto& a) { return !tells(a); });
    if (silent != here.end()) {
      out.emplace_back(fail(silent->error()));
      continue;
    }
    Identity identity;
    identity.node = nodes[i];
    identity.by_registers = session.modbus() != nullptr;
    identity.device_type = u32_in(here[0]);
    identity.vendor_id = u32_in(here[1]);
    identity.product_code = u32_in(here[2]);
    if (with_revision) identity.revision = u32_in(here[3]);
    consider_numbers(session, identity);
    out.emplace_back(std::move(identity));
  }
  return out;
}

/// False where the family that its numbers tell raises access alarms and its data do not list the object.
bool is_listed(const Session& session, std::uint8_t node, ObjectAddress object) {
  const auto* profile = session.wary_of(node);
  return profile == nullptr || profile->dictionary.find(object) != nullptr;
}

/// The rest of what tells the family: 1008h, and the own objects of the family that was named.
void read_details(Session& session, std::span<Result<Identity>> identities, const drive::Rules& rules) {
  std::vector<ObjectAddress> objects{objects::kDeviceName};
  objects.insert(objects.end(), rules.identity_looks.begin(), rules.identity_looks.end());
  std::vector<SdoRequest> requests;
  for (const auto& identity : identities)
    for (const auto object : objects)
      if (identity && is_listed(session, identity->node, object))
        requests.push_back({identity->node, object, {}});
  const auto answers = session.transfer(requests);
  auto at = answers.begin();
  for (auto& identity : identities) {
    if (!identity) continue;
    const auto node = identity->node;
    for (const auto object : rules.identity_looks) identity->looked.emplace(object, false);
    for (const auto object : objects) {
      if (!is_listed(session, node, object)) continue;
      const auto& answer = *at++;
      if (!identity) continue;
      if (!tells(answer))
        identity = fail(answer.error());
      else if (object == objects::kDeviceName)
        identity->device_name = text_in(answer);
      else
        identity->looked[object] = answer.has_value();
    }
    if (identity) session.identities().keep(*identity, session.watch().boots(node));
  }
}

/// As it is kept, if it has everything that is asked for; else null.
const Identity* known_identity(Session& session, std::uint8_t node, const drive::Rules& rules,
                               bool with_revision) {
  const auto* found = session.identities().find(node, session.watch().boots(node));
  const bool whole = found != nullptr && (!with_revision || found->revision) &&
                     std::all_of(rules.identity_looks.begin(), rules.identity_looks.end(),
                                 [&](ObjectAddress object) { return found->looked.contains(object); });
  return whole ? found : nullptr;
}

}  // namespace

std::vector<Result<Identity>> identify(Session& session, std::span<const std::uint8_t> nodes,
                                       const drive::Rules& rules) {
  const bool with_revision = std::any_of(rules.identity.begin(), rules.identity.end(),
                                         [](const auto& mark) { return mark.object == objects::kRevision; });
  std::vector<std::uint8_t> asked;
  for (const auto node : nodes)
    if (known_identity(session, node, rules, with_revision) == nullptr) asked.push_back(node);
  auto fresh = read_numbers(session, asked, with_revision);
  read_details(session, fresh, rules);
  std::vector<Result<Identity>> out;
  auto at = fresh.begin();
  for (const auto node : nodes) {
    const bool is_fresh = std::find(asked.begin(), asked.end(), node) != asked.end();
    out.push_back(is_fresh ? std::move(*at++)
                           : Result<Identity>(*known_identity(session, node, rules, with_revision)));
  }
  // What is wrong with the bus is told by what follows.
  if (!asked.empty()) (void)settle_duplicates(session, nodes, kBeforeWrites);
  return out;
}

Result<Identity> read_identity(Session& session, std::uint8_t node) {
  const std::uint8_t nodes[] = {node};
  consider_numbers(session, nodes);
  const ObjectAddress objects[] = {objects::kDeviceType, objects::kVendorId,     objects::kProductCode,
                                   objects::kRevision,   objects::kSerialNumber, objects::kDeviceName};
  std::vector<SdoRequest> requests;
  for (const auto object : objects) requests.push_back({node, object, {}});
  const auto answers = session.transfer(requests);
  Identity out;
  out.node = node;
  out.by_registers = session.modbus() != nullptr;
  std::optional<std::uint32_t>* const places[] = {&out.device_type, &out.vendor_id, &out.product_code,
                                                  &out.revision, &out.serial};
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto& answer = answers[i];
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
    if (i < std::size(places))
      *places[i] = u32_in(answer);
    else
      out.device_name = text_in(answer);
  }
  return out;
}

void look_for_families(Session& session, std::span<Identity> identities,
                       std::span<const drive::Family> families) {
  std::vector<SdoRequest> requests;
  std::vector<Identity*> whose;
  if (session.modbus() != nullptr) families = {};
  // A family that was named does not decide what is asked of a drive whose numbers contradict it.
  for (const auto& identity : identities)
    if (!identity.by_registers && (identity.device_type || identity.vendor_id))
      consider_numbers(session, identity);
  for (const auto& family : families) {
    const auto shared = drive::shared_rules(family);
    if (!shared) continue;
    const auto& rules = **shared;
    for (auto& identity : identities)
      if (fits(identity, rules))
        for (const auto object : rules.identity_looks) {
          if (!is_listed(session, identity.node, object)) {
            identity.looked.insert_or_assign(object, false);
            continue;
          }
          requests.push_back({identity.node, object, {}});
          whose.push_back(&identity);
        }
  }
  const auto answers = session.transfer(requests);
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (tells(answers[i])) whose[i]->looked.insert_or_assign(requests[i].object, answers[i].has_value());
  for (const auto& identity : identities)
    session.identities().keep(identity, session.watch().boots(identity.node));
}

Result<void> settle_duplicates(Session& session, std::span<const std::uint8_t> nodes, Duration least) {
  auto* can = session.can();
  if (can == nullptr) return {};
  auto& duplicates = can->duplicates();
  const auto patience =
      std::max<Duration>(least, std::min<Duration>(2 * duplicates.slowest_answer(), kThoroughly));
  const auto since = duplicates.last_answer().value_or(session.now());
  if (const auto heard = listen_until(session, since + patience); !heard) return heard;
  constexpr std::array kToTell = {objects::kSerialNumber, objects::kDeviceType, objects::kVendorId,
                                  objects::kProductCode};
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    if (duplicates.is_suspect(node))
      for (const auto object : kToTell) requests.push_back({node, object, {}});
  if (requests.empty()) return {};
  // The slower one answers one request after the other.
  const auto second = duplicates.slowest_second() * (kToTell.size() + 1);
  (void)session.transfer(requests);
  return listen_until(session, session.now() + std::clamp<Duration>(second, kThoroughly, kMostPatience));
}

Result<void> refuse_duplicate(Session& session, std::uint8_t node) {
  auto* can = session.can();
  if (can == nullptr) return {};
  const auto& by = can->duplicates().noticed(node);
  if (by.empty()) return {};
  return fail(drive_error(
      Errc::refused, node,
      message("two nodes answer with this node-ID ({}): writes and motion are refused", by),
      message(
          "disconnect one and give it another node-ID, then `scan` (drives with LSS take one by their serial numbers: "
          "`help lss set-node`); `disable -n {}` and `nmt stop -n {}` reach both",
          node_name(node), node_name(node))));
}

}  // namespace servoctl::session
