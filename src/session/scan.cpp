#include "session/scan.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "canopen/node_list.hpp"
#include "drive/shared_profile.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"
#include "session/can_network.hpp"
#include "session/ethercat_network.hpp"
#include "session/family_check.hpp"
#include "session/gateway_network.hpp"
#include "session/identify.hpp"
#include "session/modbus_network.hpp"
#include "session/option_scope.hpp"
#include "session/wary.hpp"

namespace servoctl::session {
namespace {

/// Where nodes are asked one after the other: from so many on each has less time.
constexpr std::size_t kFewNodes = 8;
constexpr std::array kNumbers{objects::kVendorId, objects::kProductCode, objects::kRevision,
                              objects::kSerialNumber};
constexpr std::array kTexts{objects::kDeviceName, ObjectAddress{0x1009, 0}, ObjectAddress{0x100A, 0}};

/// A node that refuses the read is there. A slave of a ring may be there and not to be asked.
bool is_away(Session& session, const Error& error) {
  return error.code == Errc::timeout || (session.ethercat() != nullptr && error.code != Errc::sdo_abort);
}

/// Of one node among many that are asked in turn.
Duration scan_patience(Session& session) {
  auto* line = session.modbus();
  return line != nullptr ? line->scan_patience() : GatewayNetwork::kScanPatience;
}

/// The first nodes' worth of requests asks who is there.
Result<std::vector<Identity>> find_nodes(Session& session, std::span<const std::uint8_t> nodes,
                                         std::vector<Error>* away) {
  // Whoever looks again may have put it right.
  if (auto* can = session.can())
    for (const auto node : nodes)
      if (!can->duplicates().noticed(node).empty()) can->duplicates().forget(node);
  std::vector<SdoRequest> requests;
  for (const auto node : nodes) requests.push_back({node, objects::kDeviceType, {}});
  const auto answers = [&] {
    const OptionScope once(session, &Options::retries, 0U);
    // A whole timeout for each that is not there would take a minute.
    const auto timeout = session.options().timeout;
    const bool many = session.network().takes_turns() && nodes.size() > kFewNodes;
    const OptionScope patience(session, &Options::timeout,
                               many ? std::min(timeout, scan_patience(session)) : timeout);
    return session.transfer(requests);
  }();
  std::vector<Identity> found;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i] && (answers[i].error().code == Errc::bus || answers[i].error().code == Errc::interrupted))
      return fail(answers[i].error());
    if (!answers[i] && is_away(session, answers[i].error())) {
      if (away != nullptr) away->push_back(answers[i].error());
      continue;
    }
    Identity identity;
    identity.node = nodes[i];
    identity.by_registers = session.modbus() != nullptr;
    identity.device_type = u32_in(answers[i]);
    found.push_back(std::move(identity));
  }
  return found;
}

/// 1018h, of those that were found. It decides what they may be asked for.
void read_numbers(Session& session, std::span<Identity> found) {
  std::vector<SdoRequest> requests;
  for (const auto& identity : found)
    for (const auto object : kNumbers) requests.push_back({identity.node, object, {}});
  const auto answers = session.transfer(requests);
  auto at = answers.begin();
  for (auto& identity : found) {
    identity.vendor_id = u32_in(*at++);
    identity.product_code = u32_in(*at++);
    identity.revision = u32_in(*at++);
    identity.serial = u32_in(*at++);
    consider_numbers(session, identity);
  }
}

void read_texts(Session& session, std::span<Identity> found) {
  std::vector<SdoRequest> requests;
  for (const auto& identity : found)
    for (const auto object : kTexts) requests.push_back({identity.node, object, {}});
  const auto answers = session.transfer(requests);
  auto at = answers.begin();
  for (auto& identity : found) {
    identity.device_name = text_in(*at++);
    identity.hardware_version = text_in(*at++);
    identity.software_version = text_in(*at++);
    identity.state = session.watch().state(identity.node);
    session.identities().keep(identity, session.watch().boots(identity.node));
  }
}

/// False where the drive has a vendor-ID and the family's data name none: 1000h alone is that of many drives.
bool names_vendor(const drive::Rules& rules, const Identity& identity) {
  return identity.vendor_id.value_or(0) == 0 ||
         std::any_of(rules.identity.begin(), rules.identity.end(),
                     [](const drive::IdentityMark& mark) { return mark.object == objects::kVendorId; });
}

}  // namespace

Result<std::vector<Identity>> scan(Session& session, std::span<const std::uint8_t> nodes,
                                   std::vector<Error>* away, const BeforeDetails& before_details) {
  auto found = find_nodes(session, nodes, away);
  if (!found) return found;
  read_numbers(session, *found);
  if (before_details) before_details(*found);
  read_texts(session, *found);
  // Where one did not answer, a second node had the whole timeout already.
  const auto least = found->size() < nodes.size() ? kBriefly : kScanning;
  std::vector<std::uint8_t> there;
  for (const auto& identity : *found) there.push_back(identity.node);
  if (const auto settled = settle_duplicates(session, there, least); !settled) return fail(settled.error());
  return found;
}

Result<std::vector<std::uint8_t>> nodes_present(Session& session) {
  if (auto* ring = session.ethercat()) return ring->nodes_with_objects();
  const auto found = find_nodes(session, canopen::every_node_id(), nullptr);
  if (!found) return fail(found.error());
  if (found->empty())
    return fail(Errc::timeout, message("no node answered on {}", as_it_is(session.url())),
                "check power, cable, termination and bitrate");
  std::vector<std::uint8_t> out;
  for (const auto& identity : *found) out.push_back(identity.node);
  const auto least = out.size() < canopen::every_node_id().size() ? kBriefly : kScanning;
  if (const auto settled = settle_duplicates(session, out, least); !settled) return fail(settled.error());
  return out;
}

std::string warning_of_details(std::span<const Identity> identities,
                               std::span<const drive::Family> families) {
  std::string nodes;
  for (const auto& identity : identities) {
    const bool known = std::any_of(families.begin(), families.end(), [&](const drive::Family& family) {
      const auto rules = drive::shared_rules(family);
      return rules && has_marks(**rules) && agrees_in_numbers(identity, **rules) &&
             names_vendor(**rules, identity);
    });
    if (!known && !identity.by_registers) append(nodes, formatted("{}", identity.node));
  }
  if (nodes.empty()) return {};
  return formatted(
      "node {}: 1000h and 1018h fit no known family; servoctl now reads its name (1008h to 100Ah) and objects of known "
      "families. Some drives raise an alarm if they do not have such an object",
      nodes);
}

std::vector<Guess> guess_families(const Identity& identity, std::span<const drive::Family> families) {
  std::vector<Guess> out;
  if (identity.by_registers) return out;  // Registers are numbers: every device has some.
  for (const auto& family : families) {
    const auto shared = drive::shared_rules(family);
    if (!shared) continue;
    const auto& rules = **shared;
    const bool generic = fits_as_generic(identity, rules);
    if (generic || may_be(identity, rules)) out.push_back({family.name, rules.identity_certain, generic});
  }
  // Two that fit: neither is proven.
  const auto own = std::count_if(out.begin(), out.end(), [](const Guess& guess) { return !guess.generic; });
  if (own > 1)
    for (auto& guess : out) guess.certain = false;
  const auto rank = [](const Guess& guess) { return guess.certain ? 0 : guess.generic ? 2 : 1; };
  std::stable_sort(out.begin(), out.end(), [&](const Guess& a, const Guess& b) { return rank(a) < rank(b); });
  return out;
}

std::vector<Guess> guess_by_sii(const Identity& identity, std::span<const drive::Family> families) {
  std::vector<Guess> out;
  for (const auto& family : families) {
    const auto shared = drive::shared_rules(family);
    if (!shared) continue;
    const auto& rules = **shared;
    if (rules.coe.exists() && agrees_in_numbers(identity, rules)) out.push_back({family.name, false, false});
  }
  return out;
}

}  // namespace servoctl::session
