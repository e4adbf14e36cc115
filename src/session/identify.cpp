#include "session/identify.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "drive/shared_profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"
#include "session/can_network.hpp"
#include "session/family_check.hpp"

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

/// Of 1000h, 1018h:01 and :02, 1008h, and 1018h:03 where it was asked for.
Identity identity_in(std::uint8_t node, std::span<const Result<Bytes>> answers, bool with_revision) {
  Identity out;
  out.node = node;
  out.device_type = u32_in(answers[0]);
  out.vendor_id = u32_in(answers[1]);
  out.product_code = u32_in(answers[2]);
  out.device_name = text_in(answers[3]);
  if (with_revision) out.revision = u32_in(answers[4]);
  return out;
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
  const auto known = [&](std::uint8_t node) { return known_identity(session, node, rules, with_revision); };
  std::vector<ObjectAddress> objects{objects::kDeviceType, objects::kVendorId, objects::kProductCode,
                                     objects::kDeviceName};
  if (with_revision) objects.push_back(objects::kRevision);
  const auto looks_at = objects.size();
  objects.insert(objects.end(), rules.identity_looks.begin(), rules.identity_looks.end());
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    if (known(node) == nullptr)
      for (const auto object : objects) requests.push_back({node, object, {}});
  const auto answers = session.transfer(requests);
  std::vector<Result<Identity>> out;
  auto at = answers.begin();
  for (const auto node : nodes) {
    if (const auto* found = known(node)) {
      out.emplace_back(*found);
      continue;
    }
    const auto here = std::span(at, objects.size());
    at += static_cast<std::ptrdiff_t>(objects.size());
    const auto silent = std::find_if(here.begin(), here.end(), [](const auto& a) { return !tells(a); });
    if (silent != here.end()) {
      out.emplace_back(fail(silent->error()));
      continue;
    }
    auto identity = identity_in(node, here, with_revision);
    identity.by_registers = session.modbus() != nullptr;
    for (std::size_t i = looks_at; i < objects.size(); ++i)
      identity.looked.emplace(objects[i], here[i].has_value());
    session.identities().keep(identity, session.watch().boots(node));
    out.emplace_back(std::move(identity));
  }
  // What is wrong with the bus is told by what follows.
  if (!requests.empty()) (void)settle_duplicates(session, nodes, kBeforeWrites);
  return out;
}

Result<Identity> read_identity(Session& session, std::uint8_t node) {
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
  for (const auto& family : families) {
    const auto shared = drive::shared_rules(family);
    if (!shared) continue;
    const auto& rules = **shared;
    for (auto& identity : identities)
      if (fits(identity, rules))
        for (const auto object : rules.identity_looks) {
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
      fmt::format("two nodes answer with this node-ID ({}): writes and motion are refused", by),
      fmt::format(
          "disconnect one and give it another node-ID, then `scan` (drives with LSS take one by their serial numbers: "
          "`help lss set-node`); `disable -n {}` and `nmt stop -n {}` reach both",
          node, node)));
}

}  // namespace servoctl::session
