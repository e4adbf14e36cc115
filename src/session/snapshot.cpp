#include "session/snapshot.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "od/real_number.hpp"
#include "session/bus_return.hpp"
#include "session/identify.hpp"
#include "session/no_register.hpp"

namespace servoctl::session {
namespace {

SdoRequest read_request(std::uint8_t node, ObjectAddress object, std::size_t size) {
  return {.node = node, .object = object, .size = size};
}

/// Puts an answer into an entry; a refusal becomes the reason, any other failure is one of the node.
Result<void> take_answer(const Result<Bytes>& answer, SnapshotEntry& entry) {
  if (answer) {
    entry.bytes = *answer;
    return {};
  }
  if (answer.error().code != Errc::sdo_abort) return fail(answer.error());
  const auto code = answer.error().abort_code;
  entry.left_out =
      code ? formatted("refused: {}", canopen::sdo_abort_text(*code)) : answer.error().message.text();
  return {};
}

/// What is no number is none to be restored.
void leave_out_no_number(const drive::DriveSetting& setting, SnapshotEntry& entry) {
  const auto value =
      entry.bytes ? od::decode(setting.entry->type, *entry.bytes) : Result<od::Value>(od::Value());
  const auto encoding = setting.parameter != nullptr ? setting.parameter->encoding : setting.entry->encoding;
  if (!entry.bytes || !value || od::is_number(encoding, *value)) return;
  entry.left_out =
      formatted("its bits, {}, are those of infinity or of no number (NaN)", to_hex(*entry.bytes));
  entry.bytes.reset();
}

/// What is read of two drives of one number, now from the one and now from the other, is of neither.
Result<void> of_one_drive(Session& session, std::uint8_t node) {
  const std::uint8_t nodes[] = {node};
  if (const auto settled = settle_duplicates(session, nodes, kBriefly); !settled) return settled;
  auto single = refuse_duplicate(session, node);
  if (single) return single;
  single.error().message =
      message("what was read may be of either of two drives: {}", single.error().message);
  return single;
}

}  // namespace

std::vector<Result<Snapshot>> take_snapshots(Session& session, const drive::Profile& profile,
                                             std::span<const std::uint8_t> nodes,
                                             const SettingFilter& wanted) {
  auto settings = drive::settings_of(profile);
  if (wanted) std::erase_if(settings, [&](const auto& s) { return !wanted(s); });
  // What this network does not reach is no part of what is asked.
  if (session.modbus() != nullptr)
    for (auto& setting : settings)
      if (setting.left_out.empty() && !profile.rules.modbus.register_of(setting.entry->address))
        setting.left_out = kNoRegister;
  const auto identities = scan(session, nodes);
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    for (const auto& setting : settings)
      if (setting.left_out.empty())
        requests.push_back(
            read_request(node, setting.entry->address, od::size_of(setting.entry->type).value_or(0)));
  const auto answers = session.transfer(requests);
  std::vector<Result<Snapshot>> out;
  std::size_t next = 0;
  for (const auto node : nodes) {
    Result<Snapshot> snapshot = Snapshot{};
    snapshot->identity.node = node;
    if (identities)
      for (const auto& identity : *identities)
        if (identity.node == node) snapshot->identity = identity;
    for (const auto& setting : settings) {
      SnapshotEntry entry{setting.entry->address, {}, std::string(setting.left_out)};
      const auto taken = setting.left_out.empty() ? take_answer(answers[next++], entry) : Result<void>{};
      leave_out_no_number(setting, entry);
      if (!taken && snapshot) snapshot = fail(taken.error());
      if (snapshot) snapshot->entries.push_back(std::move(entry));
    }
    // Two drives answering at once also break transfers: that they are two is the cause to be told.
    const auto single = of_one_drive(session, node);
    if (!single && (snapshot || single.error().code == Errc::refused)) snapshot = fail(single.error());
    out.push_back(std::move(snapshot));
  }
  return out;
}

std::vector<Result<Snapshot>> take_snapshots_patiently(Session& session, const drive::Profile& profile,
                                                       std::span<const std::uint8_t> nodes,
                                                       const SettingFilter& wanted) {
  BusReturn bus(session, BusReturn::to_people(session), nodes);
  for (;;) {
    auto out = take_snapshots(session, profile, nodes, wanted);
    const auto lost = std::find_if(out.begin(), out.end(),
                                   [](const auto& one) { return !one && one.error().code == Errc::bus; });
    if (lost == out.end()) return out;
    const auto back = bus.wait(lost->error(), session.now() + BusReturn::kPatience);
    if (back) continue;
    for (auto& one : out)
      if (back.error().code == Errc::refused) one = fail(back.error());
    return out;
  }
}

Result<std::vector<SnapshotEntry>> read_objects(Session& session, std::uint8_t node,
                                                std::span<const ObjectAddress> objects) {
  std::vector<SdoRequest> requests;
  for (const auto object : objects) requests.push_back(read_request(node, object, 0));
  const auto answers = session.transfer(requests);
  std::vector<SnapshotEntry> out;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    out.push_back({objects[i], {}, {}});
    if (const auto taken = take_answer(answers[i], out.back()); !taken) return fail(taken.error());
  }
  return out;
}

}  // namespace servoctl::session
