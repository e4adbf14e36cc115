#include "session/storage.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "session/option_scope.hpp"
#include "session/setting_write.hpp"

namespace servoctl::session {
namespace {

Result<std::vector<SdoRequest>> writes_of(const drive::Profile& profile, std::uint8_t node,
                                          std::span<const drive::Setting> settings) {
  std::vector<SdoRequest> out;
  for (const auto& setting : settings) {
    auto write = setting_write(profile, node, setting);
    if (!write) return fail(write.error());
    out.push_back(*std::move(write));
  }
  return out;
}

/// One after the other, each when the one before is done.
Result<void> carry_out(Session& session, const Result<std::vector<SdoRequest>>& writes) {
  if (!writes) return fail(writes.error());
  const OptionScope patience(session, &Options::timeout, std::max(session.options().timeout, kStorePatience));
  for (const auto& write : *writes)
    if (const auto done = session.download(write.node, write.object, *write.data); !done) return done;
  return {};
}

/// One thing went wrong, and then another.
void add_to(Error& first, const Error& next) {
  first.message += "; " + next.message;
  if (first.hint.empty()) first.hint = next.hint;
}

/// By 1010h:01.
bool stores_all(const drive::Profile& profile) {
  return profile.rules.store.objects && profile.dictionary.find(objects::kStoreAll) != nullptr;
}

/// One refusal tells nothing of the other ways; the manual was asked, too.
Result<void> with_manual(Result<void> done, const drive::Profile* profile, std::uint16_t index,
                         std::string_view hint) {
  if (done || profile == nullptr || done.error().abort_code != canopen::sdo_abort::kNoObject) return done;
  const ObjectAddress count{index, 0};
  const ObjectAddress all{index, 1};
  if (profile->dictionary.find(count) == nullptr && profile->dictionary.find(all) == nullptr)
    done.error().hint = hint;
  return done;
}

bool by_objects(const drive::Profile* profile) { return profile == nullptr || profile->rules.store.objects; }

/// Whether `param set` writes anything: where no parameter has an object, `write` does.
bool writes_by_parameter(const drive::Profile& profile) {
  return std::any_of(profile.parameters.begin(), profile.parameters.end(),
                     [](const auto& parameter) { return parameter.object.has_value(); });
}

}  // namespace

bool can_store(const drive::Profile& profile) {
  const auto& store = profile.rules.store;
  return stores_all(profile) || !store.store.empty() || !store.flash_switch.empty();
}

bool is_known_to_keep(const drive::Profile& profile, ObjectAddress object) {
  if (!can_store(profile)) return false;
  const bool of_maker = object.index >= 0x2000 && object.index < 0x6000;
  return stores_all(profile) || of_maker || profile.parameter(object) != nullptr;
}

Result<std::vector<SdoRequest>> store_writes(const drive::Profile* profile, std::uint8_t node,
                                             ParameterGroup group) {
  if (by_objects(profile))
    return std::vector<SdoRequest>{{node,
                                    {objects::kStoreIndex, static_cast<std::uint8_t>(group)},
                                    store_le(objects::kSaveSignature, 4)}};
  const auto& rules = profile->rules.store;
  if (!rules.store.empty()) return writes_of(*profile, node, rules.store);
  auto hint = rules.flash_switch.empty()
                  ? std::string("its manual describes no method; check whether values survive a power cycle")
                  : formatted("values are kept only when written: `{} … --keep` switches {}",
                              writes_by_parameter(*profile) ? "param set" : "write", rules.flash_switch);
  return fail(
      drive_error(Errc::negative, node, "this family cannot store all values at once", std::move(hint)));
}

Result<void> store_parameters(Session& session, const drive::Profile* profile, std::uint8_t node,
                              ParameterGroup group) {
  return with_manual(
      carry_out(session, store_writes(profile, node, group)), profile, objects::kStoreIndex,
      "the manual lists no object that stores, and does not say how values are kept: `verify` a "
      "backup after a power cycle");
}

Result<std::vector<SdoRequest>> restore_writes(const drive::Profile* profile, std::uint8_t node,
                                               ParameterGroup group) {
  if (by_objects(profile))
    return std::vector<SdoRequest>{{node,
                                    {objects::kRestoreIndex, static_cast<std::uint8_t>(group)},
                                    store_le(objects::kLoadSignature, 4)}};
  const auto& rules = profile->rules.store;
  if (!rules.restore.empty()) return writes_of(*profile, node, rules.restore);
  const drive::Setting at_start[] = {{rules.restore_at_start, 1}};
  if (!rules.restore_at_start.empty()) return writes_of(*profile, node, at_start);
  return fail(drive_error(Errc::negative, node, "this family cannot restore factory values over the bus",
                          "use its panel or the vendor's software"));
}

Result<void> restore_defaults(Session& session, const drive::Profile* profile, std::uint8_t node,
                              ParameterGroup group) {
  return with_manual(
      carry_out(session, restore_writes(profile, node, group)), profile, objects::kRestoreIndex,
      "the manual lists no object for it: use the panel or the vendor's software, or `restore` a backup");
}

Result<void> StorageScope::set(const std::string& name, std::int64_t value, std::optional<Changed>& out) {
  const auto request = setting_write(*profile_, node_, {name, value});
  if (!request) return fail(request.error());
  const auto before = session_->upload(node_, request->object);
  if (!before) return fail(before.error());
  if (*before == *request->data) return {};
  // Noted first: an answer that is lost may belong to a write that was done.
  out = Changed{request->object, *before, *request->data};
  return write(request->object, *request->data);
}

Result<void> StorageScope::write(ObjectAddress object, const Bytes& data) {
  if (rehearsal_ == nullptr) return session_->download(node_, object, data);
  rehearsal_->add(planned_write({node_, object, data}));
  return {};
}

/// All values in the drive: as store_parameters().
Result<void> StorageScope::store_all() {
  if (rehearsal_ == nullptr) return store_parameters(*session_, profile_, node_, ParameterGroup::all);
  const auto writes = store_writes(profile_, node_, ParameterGroup::all);
  if (!writes) return fail(writes.error());
  for (const auto& each : *writes) rehearsal_->add(planned_write(each));
  return {};
}

Result<void> StorageScope::put_back(std::optional<Changed>& changed) {
  if (!changed) return {};
  const auto object = std::exchange(changed, std::nullopt);
  return write(object->object, object->before);
}

/// A trial goes to the RAM where the family has a choice: its flash wears.
Result<void> StorageScope::choose_memory() {
  const auto& rules = profile_->rules.store;
  const auto& value = keep_ ? rules.to_flash : rules.to_ram;
  if (rules.flash_switch.empty() || !value) return {};
  if (const auto done = set(rules.flash_switch, *value, memory_); !done || !memory_ || rehearsal_ != nullptr)
    return done;
  // Where values go is not taken on trust.
  const auto found = session_->upload(node_, memory_->object);
  if (!found) return fail(found.error());
  if (*found == memory_->now) return {};
  const auto told =
      keep_ ? message("it acknowledged {} = {}, and did not take it: values would go to its RAM",
                      as_it_is(rules.flash_switch), *value)
            : message("it acknowledged {} = {}, and did not take it: values would go to its flash",
                      as_it_is(rules.flash_switch), *value);
  return fail(
      drive_error(Errc::negative, node_, memory_->object, told, "nothing was written; set it at the panel"));
}

Result<void> StorageScope::leave_flash() {
  if (!worked_in_ram()) return {};
  const Deaf deaf(*session_);
  const auto written = session_->download(node_, memory_->object, memory_->before);
  // An answer that is lost may belong to a write that was done.
  const auto found = session_->upload(node_, memory_->object);
  if (!found) return fail(found.error());
  if (*found == memory_->before) {
    memory_.reset();
    return {};
  }
  if (!written) return written;
  return fail(drive_error(Errc::negative, node_, memory_->object, "it did not go back to the RAM"));
}

/// What became of the switch between RAM and flash, once it is where it stays.
void StorageScope::tell_memory(bool stays, std::size_t writes) {
  if (keep_ || rehearsal_ != nullptr) return;
  const auto& rules = profile_->rules.store;
  if (stays)
    notices_.push_back(message(
        "node {}: {} is now {}: values go to RAM and are lost at power-off; --keep makes them permanent",
        node_name(node_), rules.flash_switch, *rules.to_ram));
  else if (writes > 0)
    notices_.push_back(
        message("node {}: what was written went to RAM and is lost at power-off; {} is as it was again",
                node_name(node_), rules.flash_switch));
}

Result<void> StorageScope::open(bool keep, bool unlock, bool choose) {
  open_ = true;
  keep_ = keep;
  const auto prepared = prepare(unlock, choose);
  if (prepared) return {};
  auto error = prepared.error();
  if (const auto closed = close(false, 0); !closed) add_to(error, closed.error());
  return fail(std::move(error));
}

Result<void> StorageScope::prepare(bool unlock, bool choose) {
  if (profile_ == nullptr) return {};
  const auto& rules = profile_->rules.store;
  const auto* password = profile_->parameter(rules.unlock);
  const bool has_password = password != nullptr && password->object && rules.unlock_open;
  // Refused before anything is written.
  if (unlock && !has_password)
    return fail(drive_error(Errc::usage, node_, "this family has no password over the bus", {}));
  if (choose)
    if (const auto chosen = choose_memory(); !chosen) return chosen;
  return unlock ? set(rules.unlock, *rules.unlock_open, password_) : Result<void>();
}

void StorageScope::tell_wear(std::size_t writes) {
  if (!profile_->rules.store.wears || writes == 0) return;
  auto& all = session_->flash_writes(node_);
  all += writes;
  notices_.push_back(message("node {}: {} written to its flash{}; each write wears it", node_name(node_),
                             writes == 1 ? "1 value was" : message("{} values were", writes),
                             all == writes ? "" : message(" ({} since the bus was opened)", all)));
}

Result<Kept> StorageScope::close(bool all_written, std::size_t writes) {
  if (!std::exchange(open_, false)) return Kept::unknown;
  const Deaf deaf(*session_);
  const bool has_switch = profile_ != nullptr && !profile_->rules.store.flash_switch.empty();
  std::optional<Error> wrong;
  const auto note = [&](const Result<void>& result, std::string_view what, std::string_view hint) {
    if (result) return;
    auto error = result.error();
    error.message = message("{}: {}", what, error.message);
    if (!hint.empty()) error.hint = hint;
    error.node = node_;
    if (wrong)
      add_to(*wrong, error);
    else
      wrong = std::move(error);
  };
  if (keep_ && has_switch && rehearsal_ == nullptr) tell_wear(writes);
  if (keep_ && all_written && !has_switch) {
    const auto stored = store_all();
    // What has no object for it stores nothing at the next try either.
    const bool never = !stored && stored.error().abort_code == canopen::sdo_abort::kNoObject;
    note(stored, "the values are written, but storing them failed",
         never ? "" : "a power cycle shows whether the drive keeps them by itself; `store` tries again");
  }
  note(put_back(password_), "the password could not be withdrawn: the drive may still be unlocked", {});
  // A switch that chose the RAM stays there: the next trial wants it, and writing it back wears the flash.
  const bool chosen = memory_.has_value();
  const auto back = keep_ || !all_written ? put_back(memory_) : Result<void>();
  note(back, "the RAM/flash switch could not be restored", {});
  if (chosen && back) tell_memory(all_written, writes);
  if (wrong) return fail(std::move(*wrong));
  if (has_switch) return keep_ ? Kept::yes : Kept::no;
  return keep_ && all_written ? Kept::yes : Kept::unknown;
}

}  // namespace servoctl::session
