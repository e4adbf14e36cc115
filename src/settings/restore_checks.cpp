// What of a backup a drive can take: each value, and the PDOs that they make.
#include <algorithm>

#include "base/format.hpp"
#include "session/pdo_setup.hpp"
#include "settings/change.hpp"
#include "settings/energising.hpp"
#include "settings/restore_target.hpp"
#include "show/pdo_check.hpp"

namespace servoctl::settings {
namespace {

using canopen::Pdo;

/// As `pdo map` and its kin would take it: `all` are the PDOs of the drive as they will be.
Result<void> check_pdo(const drive::Profile& profile, const Pdo& present, const Pdo& wanted,
                       std::span<const Pdo> all) {
  if (present.entries != wanted.entries)
    if (const auto maps = show::check_mapping(profile, wanted); !maps) return maps;
  return show::check_communication(profile, present, wanted, all);
}

}  // namespace

tl::unexpected<Error> RestoreTarget::unfit(Errc code, ObjectAddress object, const Message& what,
                                           Message hint) const {
  const auto copy = copies_.find(object);
  const auto of = copy == copies_.end() ? "" : to_string(copy->second) + ": its stored copy ";
  const auto name = of + drive::target_at(desk_->profile, object).in_sentence();
  auto error = fail(code, message("{}: {}: {}", place_of(object), name, what), std::move(hint)).value();
  error.node = node_;
  error.object = object;
  return fail(std::move(error));
}

/// `outside` tells whether the only thing against it is a limit.
Result<void> RestoreTarget::check_value(ObjectAddress object, const Bytes& data, bool& outside) const {
  const auto target = drive::target_at(desk_->profile, object);
  const auto meaning = drive::fitted(drive::meaning(target, node_), data.size());
  const auto value =
      meaning.type_known ? od::decode(meaning.type, data) : Result<od::Value>(od::Value(std::uint64_t{0}));
  if (!od::writable(meaning.access))
    return unfit(Errc::negative, object, "is read-only", "nothing was written");
  if (!value) return unfit(Errc::negative, object, value.error().message, "nothing was written");
  if (const auto free = check_writable(*desk_, node_, object, data); !free)
    return unfit(Errc::refused, object, free.error().message, "nothing was written; " + free.error().hint);
  const auto limits = meaning.type_known ? drive::check_limits(meaning, *value) : Result<void>{};
  outside = !limits;
  return limits ? limits : unfit(Errc::negative, object, limits.error().message, "nothing was written");
}

/// Nothing is written unless everything can be. What the drive holds already is none of it. A backup of ours
/// says what a drive held, within its limits or not: that is named and stays as it is, and keeps nobody from
/// the rest. What the file says is wrong before what is made of it.
Result<void> RestoreTarget::check_values() {
  const auto of_file = check_each(false);
  return of_file ? check_each(true) : of_file;
}

Result<void> RestoreTarget::check_each(bool copies) {
  for (auto next = wanted_.begin(); next != wanted_.end();) {
    const auto [object, data] = *next++;
    if ((copies_.count(object) > 0) != copies) continue;
    bool outside = false;
    const auto fits = present_.at(object) == data ? Result<void>() : check_value(object, data, outside);
    if (fits) continue;
    auto error = fits.error();
    const bool skipped = choice_.skip_invalid && error.code == Errc::negative;
    if (!skipped && (!outside || !backup_->proven)) {
      if (error.code == Errc::negative) error.hint += "; --skip-invalid restores the rest";
      return fail(std::move(error));
    }
    error.message += message("; node {} keeps {}", node_name(node_), to_hex(present_.at(object)));
    error.hint = skipped ? "" : "the drive may not accept its own original value again: `write` it if needed";
    left_.push_back(std::move(error));
    ++left_count_;
    unsent_wanted_.insert(wanted_.extract(object));
    unsent_present_.insert(present_.extract(object));
  }
  return {};
}

/// What a drive held as a whole, it takes as a whole; what others wrote, or a part, has to fit the PDOs that
/// are there.
Result<void> RestoreTarget::check_pdos() {
  if (backup_->proven) return {};
  const auto changes = [this](const auto& value) {
    return pdo_at(value.first.index) && present_.at(value.first) != value.second;
  };
  if (std::none_of(wanted_.begin(), wanted_.end(), changes)) return {};
  const std::uint8_t nodes[] = {node_};
  auto values = std::move(session::read_pdo_values(*desk_->session, desk_->profile, nodes).front());
  if (!values) return fail(values.error());
  const auto present = session::pdos_of(*values);
  for (const auto& [object, data] : wanted_)
    if (pdo_at(object.index)) values->insert_or_assign(object, data);
  const auto wanted = session::pdos_of(*values);
  for (const auto& was : present) {
    const auto same = [&](const Pdo& pdo) {
      return pdo.direction == was.direction && pdo.number == was.number;
    };
    const auto of_it = [&](const auto& value) {
      return changes(value) &&
             (value.first.index == was.communication_index() || value.first.index == was.mapping_index());
    };
    const auto now = std::find_if(wanted.begin(), wanted.end(), same);
    if (now == wanted.end() || std::none_of(wanted_.begin(), wanted_.end(), of_it)) continue;
    if (const auto fits = check_pdo(*desk_->profile, was, *now, wanted); !fits)
      return unfit(Errc::refused, std::find_if(wanted_.begin(), wanted_.end(), of_it)->first,
                   fits.error().message, "nothing was written; " + fits.error().hint);
  }
  return {};
}

}  // namespace servoctl::settings
