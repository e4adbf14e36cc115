#include "settings/equal_values.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/storage.hpp"
#include "settings/energising.hpp"
#include "settings/register_writes.hpp"

namespace servoctl::settings {
namespace {

/// Whether the family's rules name the parameter: they do so because its writing does something.
bool is_named_by_rules(const drive::Profile& profile, const od::Parameter& parameter) {
  const auto& rules = profile.rules;
  const auto& store = rules.store;
  std::vector<std::string> names{store.flash_switch, store.unlock, store.restore_at_start,
                                 store.clear_alarms_at_start};
  const auto add = [&](const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  add(store.locked);
  add(rules.modbus.at_rest);
  add(rules.modbus.targets);
  for (const auto* settings : {&store.store, &store.restore})
    for (const auto& setting : *settings) names.push_back(setting.name);
  for (const auto& power : rules.motion.without_controlword) {
    names.push_back(power.name);
    names.push_back(power.end);
  }
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return !name.empty() && drive::place_of(profile, name) == parameter.object;
  });
}

/// A setting and nothing else: what is read is what a write has set, and writing it again does nothing.
bool is_plain_value(const show::Desk& desk, const Change& change) {
  const auto* parameter = change.target.parameter;
  if (desk.profile == nullptr || desk.profile->made_of_dictionary || parameter == nullptr) return false;
  const auto index = change.target.address.index;
  const bool of_maker = index >= 0x2000 && index < 0x6000;
  const auto* entry = change.target.entry;
  return of_maker && parameter->access == od::Access::rw && !parameter->command && !parameter->is_volatile &&
         !parameter->mirror && !parameter->doubts.about("name") && (entry == nullptr || !entry->command) &&
         reason_to_ask(desk, change).empty() && register_reason(desk, change).empty() &&
         !is_named_by_rules(*desk.profile, *parameter);
}

/// Whether what is read is what is to be kept: a switch of the memory may have left an older value in the
/// flash, and a drive that nothing tells to store may keep what is written.
bool is_stored_as_read(const show::Desk& desk, const WriteOptions& options) {
  if (!options.keep) return true;
  return session::can_store(*desk.profile) && desk.profile->rules.store.flash_switch.empty();
}

std::vector<Result<Bytes>> read_present(show::Desk& desk, std::span<const Change> changes,
                                        std::span<const std::size_t> asked) {
  std::vector<session::SdoRequest> requests;
  for (const auto i : asked)
    requests.push_back({.node = changes[i].node,
                        .object = changes[i].target.address,
                        .transfer = changes[i].transfer,
                        .size = changes[i].data.size()});
  return desk.session->transfer(requests);
}

}  // namespace

void mark_unchanged(show::Desk& desk, std::vector<Change>& changes, const WriteOptions& options) {
  if (!options.leave_equal || desk.profile == nullptr || !check_registers(desk, changes)) return;
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (is_plain_value(desk, changes[i])) asked.push_back(i);
  if (asked.empty()) return;
  const auto present = read_present(desk, changes, asked);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    if (!present[k]) continue;
    auto& change = changes[asked[k]];
    change.before = *present[k];
    change.unchanged = is_stored_as_read(desk, options) && *present[k] == change.data;
  }
}

std::vector<Result<session::Written>> write_open(show::Desk& desk, std::span<const Change> changes,
                                                 std::span<const session::SdoRequest> requests,
                                                 bool read_back) {
  std::vector<session::SdoRequest> open;
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (!changes[i].unchanged) open.push_back(requests[i]);
  auto done = session::write_all(*desk.session, open, read_back);
  std::vector<Result<session::Written>> out;
  std::size_t next = 0;
  for (const auto& change : changes)
    out.push_back(change.unchanged ? session::Written{false, change.before} : std::move(done[next++]));
  return out;
}

void write_altered(show::Desk& desk, std::vector<Change>& changes,
                   std::vector<Result<session::Written>>& written) {
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (changes[i].unchanged && std::any_of(changes.begin(), changes.end(), [&](const Change& other) {
          return other.node == changes[i].node && !other.unchanged;
        }))
      asked.push_back(i);
  if (asked.empty()) return;
  const auto present = read_present(desk, changes, asked);
  std::vector<session::SdoRequest> requests;
  std::vector<std::size_t> again;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const auto i = asked[k];
    if (present[k] && *present[k] == changes[i].data) continue;
    changes[i].unchanged = false;
    if (!present[k]) {
      written[i] = fail(present[k].error());
      continue;
    }
    again.push_back(i);
    requests.push_back({changes[i].node, changes[i].target.address, changes[i].data, changes[i].transfer});
  }
  auto done = session::write_all(*desk.session, requests, true);
  for (std::size_t k = 0; k < again.size(); ++k) written[again[k]] = std::move(done[k]);
}

}  // namespace servoctl::settings
