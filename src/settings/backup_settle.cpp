#include <algorithm>
#include <map>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "session/communication_order.hpp"
#include "settings/backup_formats.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {
namespace {

/// What is written twice in a procedure: the records of PDOs, and what assigns fixed ones (invalid or count 0
/// first, the entries, then what is to be), and communication objects that are cleared first.
bool is_of_procedure(ObjectAddress object) {
  return session::is_written_in_steps(object) || pdo_at(object.index).has_value() ||
         (object.index >= 0x1C10 && object.index <= 0x1C2F);
}

tl::unexpected<Error> refuse(const std::string& file, const Backup::Entry& entry, const Message& what,
                             Message hint) {
  auto error =
      fail(Errc::file, message("{}:{}: {} {}", as_it_is(file), entry.line, to_string(entry.object), what),
           std::move(hint))
          .value();
  error.line = entry.line;
  error.object = entry.object;
  return fail(std::move(error));
}

/// Why the drive's family says that this is nothing to put back; empty when it is a setting.
std::string_view reason_of(const std::map<ObjectAddress, std::string_view>& reasons, ObjectAddress object) {
  const auto found = reasons.find(object);
  return found == reasons.end() ? std::string_view("read-only") : found->second;
}

/// An integer of the file's type as one of the family's: a tool may write a byte as 32 bits.
Result<Bytes> resized(const Backup::Entry& entry, od::DataType type) {
  const auto value = od::decode(entry.type, *entry.bytes);
  if (!value || !od::is_integer(entry.type) || !od::is_integer(type))
    return fail(Errc::file,
                message("has {} bytes, and {} is of another length", entry.bytes->size(), od::name(type)));
  return od::encode(type, *value);
}

Result<void> settle_value(Backup::Entry& entry, const drive::Target& target, const std::string& file,
                          std::uint8_t node) {
  const auto meaning = drive::fitted(drive::meaning(target, node), entry.bytes->size());
  const auto size = od::size_of(meaning.type);
  if (size && *size != entry.bytes->size()) {
    auto bytes = resized(entry, meaning.type);
    if (!bytes)
      return refuse(file, entry, message("({}): {}", name_of(target), bytes.error().message),
                    "is it a file of this drive family?");
    entry.bytes = std::move(*bytes);
  }
  entry.type = meaning.type;
  return {};
}

}  // namespace

void settle(Backup& backup, const std::string& file, const drive::Profile& profile, bool procedure) {
  std::map<ObjectAddress, std::string_view> reasons;
  for (const auto& setting : drive::settings_of(profile))
    reasons.emplace(setting.entry->address, setting.left_out);
  backup.family = profile.family;
  std::map<ObjectAddress, Backup::Entry> entries;
  const auto take = [&](Backup::Entry& entry) -> Result<void> {
    const auto target = drive::target_at(&profile, entry.object);
    if (target.entry == nullptr && target.parameter == nullptr)
      return refuse(file, entry, message("is unknown to {}", as_it_is(profile.family)),
                    "is it a file of this drive family? remove the entry when it is");
    if (!procedure || !is_of_procedure(entry.object))
      if (const auto first = entries.find(entry.object); first != entries.end())
        return refuse(file, entry, message("appears again, first in {}", first->second.line),
                      "remove one of them");
    entry.id = target.parameter != nullptr ? target.parameter->id : std::string();
    entry.name = target.parameter != nullptr ? target.parameter->name : target.label();
    if (entry.bytes)
      if (const auto reason = reason_of(reasons, entry.object); !reason.empty()) {
        entry.bytes.reset();
        entry.left_out = reason;
      }
    if (entry.bytes)
      if (const auto fits = settle_value(entry, target, file, backup.identity.node); !fits) return fits;
    entries.insert_or_assign(entry.object, std::move(entry));
    return {};
  };
  for (auto& entry : backup.entries)
    if (const auto taken = take(entry); !taken) backup.unusable.push_back(taken.error());
  backup.entries.clear();
  for (auto& entry : entries) backup.entries.push_back(std::move(entry.second));
}

}  // namespace servoctl::settings
