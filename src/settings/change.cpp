#include "settings/change.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/assumed_unit.hpp"
#include "drive/drive_settings.hpp"
#include "drive/unit.hpp"
#include "session/cob_id_check.hpp"
#include "session/drive_units.hpp"
#include "session/measure.hpp"
#include "settings/energising.hpp"
#include "settings/equal_values.hpp"
#include "settings/keeping_nodes.hpp"
#include "settings/own_size.hpp"
#include "settings/register_writes.hpp"
#include "settings/stored_copies.hpp"
#include "show/alarm_question.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Value;

/// An object whose length no manual tells is read to learn it: a write of another length would be refused or
/// worse.
Result<drive::Meaning> learn_size(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                                  const drive::Meaning& meaning) {
  const auto bytes = desk.session->upload(node, target.address);
  if (!bytes) {
    auto error = bytes.error();
    error.message = "the object's size is not known, and reading it failed: " + error.message;
    const bool absent = error.abort_code == canopen::sdo_abort::kNoObject;
    error.hint =
        desk.profile == nullptr ? Message("give the type: --type i32, or the drive family: -d FAMILY")
        : absent ? message("`objects -d {}` lists the objects it has", as_it_is(desk.profile->family))
                 : Message("say the type: --type i32");
    return fail(std::move(error));
  }
  auto learned = learned_meaning(node, target, meaning, *bytes);
  if (!learned)
    return fail(
        Errc::negative,
        message("the object has {} bytes, which does not fit {}", bytes->size(), od::name(meaning.type)),
        "say the type: --type i32");
  if (learned->type != meaning.type || !meaning.type_known)
    desk.notices.push_back(message("node {}, object {}: type taken as {} from its length", node_name(node),
                                   to_string(target.address), od::name(learned->type)));
  return *learned;
}

/// Whether only the drive's own gear and ratings tell what the unit in the text is.
bool asks_measure(const show::Desk& desk, const drive::Meaning& meaning, std::string_view text) {
  return meaning.measure && desk.profile != nullptr && drive::needs_bridge(meaning, text);
}

/// A gear that takes effect at a restart may be set and not in force: what is written then is converted by
/// numbers the drive does not go by yet.
void warn_of_gear(show::Desk& desk, std::uint8_t node, drive::Measure measure) {
  std::set<std::string> ids;
  for (const auto& way : desk.profile->rules.units.at(measure))
    for (const auto object : way.objects()) {
      const auto target = drive::target_at(desk.profile, object);
      if (drive::meaning(target, node).effect == od::Effect::restart && target.parameter != nullptr)
        ids.insert(target.parameter->id);
    }
  if (ids.empty()) return;
  const auto notice = message(
      "node {}: the unit is converted by {}, valid only if the drive was restarted after they changed",
      node_name(node), NameList{{ids.begin(), ids.end()}});
  if (std::find(desk.notices.begin(), desk.notices.end(), notice) == desk.notices.end())
    desk.notices.push_back(notice);
}

/// What the drive's gear makes of the unit in the text, where only the drive can tell. Errors of an answer
/// that was lost.
Result<void> add_bridge(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                        std::string_view text, drive::Meaning& meaning) {
  if (!asks_measure(desk, meaning, text)) return {};
  const session::MeasureQuestion question[] = {{node, *meaning.measure}};
  std::optional<Error> unanswered;
  const auto measure = session::read_measures(*desk.session, *desk.profile, question, &unanswered).front();
  if (unanswered) return fail(*unanswered);
  if (!measure) return {};
  meaning.bridge = drive::bridge(meaning.unit, target.address, measure->value);
  warn_of_gear(desk, node, question[0].measure);
  return {};
}

/// A number with a unit, for an object whose unit the family's data only assume: by the drive's own.
bool asks_unit(const show::Desk& desk, const drive::Target& target, std::string_view text) {
  return drive::is_unit_assumed(target) && desk.profile != nullptr && !parse_integer(trim(text)) &&
         drive::split_unit(trim(text)).has_value();
}

Result<void> prove_unit(const session::DriveUnits& own, const drive::Target& target, drive::Meaning& meaning,
                        std::string_view text) {
  if (own.unanswered()) return fail(*own.unanswered());
  if (!own.proves(target))
    return fail(Errc::usage,
                message("'{}': the unit of this object is not known: neither the drive's data nor the drive "
                        "(60A8h, 60A9h, 60AAh) states it",
                        as_it_is(text)),
                "write the plain number that the drive takes; its manual gives the unit");
  own.apply(target, meaning);
  return {};
}

tl::unexpected<Error> named(Error error, std::uint8_t node, const drive::Target& target) {
  error.message = target.in_sentence() + ": " + error.message;
  return fail(show::located(std::move(error), node, target.address));
}

bool is_unknown(const drive::Profile* profile, const drive::Target& target) {
  return profile != nullptr && target.entry != nullptr && drive::is_access_unknown(*profile, *target.entry);
}

Result<drive::Meaning> writable_meaning(const drive::Profile* profile, std::uint8_t node,
                                        const drive::Target& target, std::optional<od::DataType> type) {
  auto meaning = drive::meaning(target, node);
  const auto refused = [&](Message why, Message hint) {
    return fail(
        show::located(make_error(Errc::usage, std::move(why), std::move(hint)), node, target.address));
  };
  if (!od::writable(meaning.access) && is_unknown(profile, target))
    return refused(
        message("{} is not known to be writable: `eds learn` cannot see that", target.in_sentence()),
        message("where the manual says so, change its AccessType to rw in {}",
                as_it_is(profile->data_sheet.string())));
  if (!od::writable(meaning.access))
    return refused(message("{} is read-only", target.in_sentence()),
                   "`read` shows its value; servoctl cannot set it");
  if (type) meaning.type = *type;
  return meaning;
}

Result<Change> change_to(const drive::Profile* profile, std::uint8_t node, const drive::Target& target,
                         const drive::Meaning& meaning, std::string_view value) {
  const auto parsed = drive::parse_quantity(meaning, value);
  if (!parsed) return named(parsed.error(), node, target);
  const auto data = od::encode(meaning.type, *parsed);
  if (!data) return named(data.error(), node, target);
  if (const auto free = session::check_cob_id(profile, target.address, *data, node); !free)
    return named(free.error(), node, target);
  Change out{node, target, meaning.type, *data};
  out.bridge = meaning.bridge;
  return out;
}

std::string effect_text(od::Effect effect) {
  switch (effect) {
    case od::Effect::immediate: return "at once";
    case od::Effect::restart: return "after a restart of the drive";
    case od::Effect::standstill: return "at standstill";
    case od::Effect::unstated: break;
  }
  return {};
}

/// A refusal that the family's password may explain says so.
Error with_password_hint(const show::Desk& desk, const Change& change, const WriteOptions& options,
                         Error error) {
  if (desk.profile == nullptr || options.unlock || error.code != Errc::sdo_abort) return error;
  const auto& store = desk.profile->rules.store;
  const auto* password = desk.profile->parameter(store.unlock);
  const bool vendor_object = change.target.address.index >= 0x2000 && change.target.address.index < 0x6000;
  if (password == nullptr || !password->object || !store.unlock_open || !vendor_object) return error;
  error.hint = message("it may be locked by {}: add --unlock", password->id);
  return error;
}

report::List change_row(const Change& change, const Result<session::Written>& written, const Value& kept,
                        const show::Desk& desk) {
  show::Reading reading{change.node, change.target, change.type, change.data, change.bridge};
  if (desk.profile != nullptr && drive::leaves_units_open(*desk.profile)) show::leave_units_open(reading);
  const auto decoded = show::decode_value(reading, change.data);
  const auto effect = drive::meaning(change.target, change.node).effect;
  const auto name = desk.chinese ? change.target.label_zh() : change.target.label();
  const bool known = session::write_end(written, change.target.address) != session::WriteEnd::unknown;
  return {change.node,
          to_string(change.target.address),
          change.target.address.index,
          change.target.address.sub,
          report::text_or_null(name),
          change.target.parameter != nullptr ? Value(change.target.parameter->id) : Value(),
          decoded.text,
          decoded.raw.is_null() ? decoded.value : decoded.raw,
          decoded.value,
          report::text_or_null(decoded.unit),
          decoded.familiar,
          decoded.label,
          change.unchanged ? "unchanged" : session::state_text(written, change.target.address),
          known ? Value(written.has_value()) : Value(),
          known ? Value(written.has_value() && !change.unchanged) : Value(),
          written ? Value(written->read_back.has_value()) : Value(false),
          written ? kept : Value(),
          written && !(change.unchanged && kept.is_null()) ? kept_text(kept) : Value(),
          written && !change.unchanged ? report::text_or_null(effect_text(effect)) : Value(),
          report::text_or_null(std::string(od::name(effect))),
          written ? Value() : show::error_record(written.error(), show::abort_words(desk, written.error()))};
}

}  // namespace

std::optional<drive::Meaning> learned_meaning(std::uint8_t node, const drive::Target& target,
                                              const drive::Meaning& meaning, const Bytes& bytes) {
  auto out = drive::fitted(meaning, bytes.size());
  if (!meaning.type_known) out.type = show::type_of({node, target, {}, bytes}, bytes);
  if (const auto size = od::size_of(out.type); size && *size != bytes.size()) return std::nullopt;
  return out;
}

std::string name_of(const drive::Target& target) {
  const auto label = target.label();
  return label.empty() ? to_string(target.address) : label;
}

Result<Change> make_change(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                           std::string_view value, std::optional<od::DataType> type) {
  auto meaning = writable_meaning(desk.profile, node, target, type);
  if (!meaning) return fail(meaning.error());
  if (!desk.dry_run || !type)
    if (const auto agreed = show::confirm_unlisted(desk, node, std::span(&target, 1)); !agreed)
      return fail(agreed.error());
  if (!type && (!meaning->type_known || !meaning->size_known)) {
    meaning = learn_size(desk, node, target, *meaning);
    if (!meaning) return fail(meaning.error());
  }
  std::optional<session::DriveUnits> own;  // Meaning::unit points into it.
  if (asks_unit(desk, target, value)) {
    own.emplace(*desk.session, *desk.profile, node);
    if (const auto proven = prove_unit(*own, target, *meaning, value); !proven)
      return named(proven.error(), node, target);
  }
  if (const auto added = add_bridge(desk, node, target, value, *meaning); !added) return fail(added.error());
  auto change = change_to(desk.profile, node, target, *meaning, value);
  if (change) change->type_given = type.has_value();
  return change;
}

Result<void> check_change(const show::Desk& desk, std::uint8_t node, const drive::Target& target,
                          std::string_view value, std::optional<od::DataType> type) {
  const auto meaning = writable_meaning(desk.profile, node, target, type);
  if (!meaning) return fail(meaning.error());
  const bool asks_size = !type && (!meaning->type_known || !meaning->size_known);
  if (asks_size || asks_unit(desk, target, value) || asks_measure(desk, *meaning, value)) return {};
  if (const auto change = change_to(desk.profile, node, target, *meaning, value); !change)
    return fail(change.error());
  return {};
}

namespace {

report::Table change_table() {
  report::Table table;
  table.columns = {{"node"},
                   {"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name"},
                   {"id", "", Show::json},
                   {"text", "value", Show::text},
                   {"raw", "", Show::json},
                   {"value", "", Show::json},
                   {"unit", "", Show::json},
                   {"si", "", Show::json},
                   {"label", "", Show::json},
                   {"state", "result", Show::text},
                   {"written", "", Show::json},
                   {"changed", "", Show::json},
                   {"read_back", "", Show::json},
                   {"kept", "", Show::json},
                   {"kept_text", "kept", Show::text},
                   {"when", "takes effect", Show::text},
                   {"effect", "", Show::json},
                   {"error", "", Show::json}};
  return table;
}

/// What the drive goes by until its restart is read before it is replaced: the session keeps it
/// (session::OwedRestarts).
void read_in_force(show::Desk& desk, std::span<const Change> changes) {
  std::vector<session::SdoRequest> requests;
  for (const auto& change : changes)
    if (!change.before && drive::meaning(change.target, change.node).effect == od::Effect::restart)
      requests.push_back({.node = change.node, .object = change.target.address});
  if (!requests.empty()) (void)desk.session->transfer(requests);
}

}  // namespace

Result<Value> write_changes(show::Desk& desk, std::span<const Change> wanted, const WriteOptions& options) {
  auto changes = changes_with(desk, wanted, options);
  mark_unchanged(desk, changes, options);
  std::vector<session::SdoRequest> requests;
  for (const auto& change : changes)
    requests.push_back({change.node, change.target.address, change.data, change.transfer});
  KeepingNodes keeping(desk, changes);
  if (const auto opened = keeping.open(options); !opened) return fail(opened.error());
  const bool energises = std::any_of(changes.begin(), changes.end(), [&](const Change& change) {
    return enables(change) || power_parameter(desk, change) != nullptr;
  });
  const auto hold = desk.session->protect(energises ? session::Care::energised : session::Care::none);
  read_in_force(desk, changes);
  const bool read_back = options.read_back || options.keep || is_only_echoed(desk, changes);
  auto written = write_open(desk, changes, requests, read_back);
  write_in_own_size(desk, changes, requests, written, read_back);
  write_altered(desk, changes, written);
  keeping.close(written);
  for (const auto& change : changes)
    if (enables(change)) desk.session->energised().insert(change.node);
  tell_not_at_rest(desk, changes, written);
  tell_power_parameters(desk, changes, written);
  auto table = change_table();
  table.json_only = std::none_of(written.begin(), written.end(), [](const auto& w) { return w.has_value(); });
  for (std::size_t i = 0; i < changes.size(); ++i) {
    table.rows.push_back(change_row(changes[i], written[i], keeping.kept(changes[i]), desk));
    if (!written[i]) desk.errors.push_back(with_password_hint(desk, changes[i], options, written[i].error()));
    if (written[i] && written[i]->answer_lost)
      desk.notices.push_back(
          message("node {}, object {}: the answer to the write was lost; the value read back is correct",
                  node_name(changes[i].node), to_string(changes[i].target.address)));
  }
  return table;
}

}  // namespace servoctl::settings
