#include "show/owed_restart.hpp"

#include <algorithm>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/regular_files.hpp"
#include "base/text.hpp"
#include "canopen/node_id.hpp"
#include "canopen/node_list.hpp"
#include "session/identify.hpp"
#include "session/open_bus.hpp"
#include "session/option_scope.hpp"
#include "show/bus_name.hpp"
#include "show/field_reader.hpp"
#include "show/identity.hpp"
#include "show/reading.hpp"

namespace servoctl::show {
namespace {

namespace fs = std::filesystem;
using report::Record;
using report::Value;
using session::OwedValue;

constexpr std::uint64_t kVersion = 1;
constexpr std::uintmax_t kMostBytes = 1U << 18U;

Value hex_or_null(const std::optional<Bytes>& bytes) { return bytes ? Value(to_hex(*bytes)) : Value(); }

std::string value_text(const drive::Target& target, std::uint8_t node, const Bytes& bytes, bool chinese) {
  const auto decoded = decode_value({.node = node, .target = target, .type = {}}, bytes);
  const auto& words = chinese && !decoded.label_zh.is_null() ? decoded.label_zh : decoded.label;
  const auto* label = std::get_if<std::string>(&words.data());
  return label == nullptr ? decoded.text : formatted("{} {}", decoded.text, *label);
}

std::string owed_name(const drive::Profile* profile, ObjectAddress object) {
  const auto target = drive::target_at(profile, object);
  return target.parameter != nullptr ? target.parameter->id : to_string(object);
}

tl::unexpected<Error> damaged(Message message) {
  return fail(Errc::file, std::move(message), "delete the file; it only says what waits for a restart");
}

Result<OwedValue> value_of(const Value& record, const std::string& file) {
  FieldReader fields(record, as_it_is(file));
  OwedValue out;
  out.object = {static_cast<std::uint16_t>(fields.number("index", true).value_or(0) & 0xFFFFU),
                static_cast<std::uint8_t>(fields.number("sub", true).value_or(0) & 0xFFU)};
  const auto stored = parse_hex_bytes(fields.text("stored", true));
  const auto in_force = fields.text("in_force");
  out.kept = fields.flag("kept");
  if (!in_force.empty()) out.in_force = parse_hex_bytes(in_force);
  if (!stored || (!in_force.empty() && !out.in_force)) fields.refuse("stored");
  if (fields.error()) return damaged(*fields.error());
  out.stored = *stored;
  return out;
}

/// What the names of the files of a bus begin with; the node and `.json` follow.
std::string name_of(std::string_view bus_url) {
  return formatted("restart-{}-node-", bus_name(session::url_without_bitrate(bus_url)));
}

}  // namespace

OwedRestartFile::OwedRestartFile(const fs::path& state_folder, std::string_view bus_url, std::uint8_t node)
    : node_(node) {
  if (!state_folder.empty()) path_ = state_folder / formatted("{}{}.json", name_of(bus_url), node);
}

std::vector<std::uint8_t> owing_nodes(const fs::path& state_folder, std::string_view bus_url) {
  std::vector<std::uint8_t> out;
  const auto begin = name_of(bus_url);
  std::error_code error;
  for (fs::directory_iterator file(state_folder, error), end; !error && file != end; file.increment(error)) {
    const auto name = file->path().filename().string();
    if (!name.starts_with(begin)) continue;
    for (const auto node : canopen::every_node_id())
      if (std::string_view(name).substr(begin.size()) == formatted("{}.json", node)) out.push_back(node);
  }
  std::ranges::sort(out);
  return out;
}

bool OwedRestartFile::is_there() const {
  std::error_code error;
  return !path_.empty() && fs::exists(fs::symlink_status(path_, error));
}

Result<std::optional<OwedRestart>> OwedRestartFile::read() const {
  const RegularFilesOnly regular;
  if (!is_there()) return std::optional<OwedRestart>();
  const auto file = path_.string();
  const auto text = read_file(path_, kMostBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, file);
  if (!document) return damaged(document.error().message);
  FieldReader fields(*document, as_it_is(file));
  if (fields.number("servoctl_restart", true).value_or(kVersion) != kVersion)
    fields.refuse("servoctl_restart");
  if (fields.number("node", true).value_or(node_) != node_) fields.refuse("node");
  const auto* inside = report::find(*document, "identity");
  auto identity = inside == nullptr ? std::nullopt : identity_of(*inside, node_);
  const auto* values = report::find(*document, "values");
  const auto* list = values == nullptr ? nullptr : std::get_if<report::List>(&values->data());
  const bool by_power = fields.flag("by_power");
  if (!identity) fields.refuse("identity");
  if (list == nullptr) fields.refuse("values");
  if (fields.error()) return damaged(*fields.error());
  OwedRestart out{.identity = std::move(*identity), .values = {}, .by_power = by_power};
  out.node_id = parse_object_address(fields.text("node_id"));
  if (const auto bitrate = fields.number("bus_bitrate"))
    out.bus_bitrate = static_cast<std::uint32_t>(*bitrate);
  if (fields.error()) return damaged(*fields.error());
  for (const auto& one : *list) {
    auto value = value_of(one, file);
    if (!value) return fail(value.error());
    out.values.push_back(std::move(*value));
  }
  return std::optional(std::move(out));
}

Result<void> OwedRestartFile::write(const OwedRestart& owed) const {
  const RegularFilesOnly regular;
  report::List list;
  for (const auto& value : owed.values)
    list.emplace_back(Record{{"index", std::uint64_t{value.object.index}},
                             {"sub", std::uint64_t{value.object.sub}},
                             {"in_force", hex_or_null(value.in_force)},
                             {"stored", to_hex(value.stored)},
                             {"kept", value.kept}});
  const Record document{{"servoctl_restart", kVersion},
                        {"node", std::uint64_t{node_}},
                        {"time", utc_now_text()},
                        {"by_power", owed.by_power},
                        {"node_id", owed.node_id ? Value(to_string(*owed.node_id)) : Value()},
                        {"bus_bitrate", owed.bus_bitrate ? Value(*owed.bus_bitrate) : Value()},
                        {"identity", identity_record(lasting(owed.identity))},
                        {"values", std::move(list)}};
  return write_file_atomically(path_, report::to_json(document) + "\n");
}

void OwedRestartFile::remove() const {
  std::error_code error;
  fs::remove(path_, error);
}

std::optional<std::uint8_t> next_node_id(const std::vector<OwedValue>& values,
                                         const std::optional<ObjectAddress>& node_id) {
  if (!node_id) return std::nullopt;
  const auto waiting = std::ranges::find(values, *node_id, &OwedValue::object);
  if (waiting == values.end() || waiting->stored.empty() || waiting->stored.size() > 8) return std::nullopt;
  const auto number = load_le(waiting->stored);
  return number >= 1 && number <= canopen::kLastNode ? std::optional(static_cast<std::uint8_t>(number))
                                                     : std::nullopt;
}

namespace {

/// Whether they cannot be one drive, as far as both say what they are.
bool is_other(const session::Identity& kept, const session::Identity& now) {
  return !other_kind(kept, now).empty() || (kept.serial && now.serial && *kept.serial != *now.serial);
}

/// Whether they are one drive for certain. Serial numbers of 0 say nothing.
bool is_same(const session::Identity& kept, const session::Identity& now) {
  return kept.serial.value_or(0) != 0 && kept.serial == now.serial && other_kind(kept, now).empty();
}

/// Whether the drive of the record answers at the node-ID that waited: by its serial number, or one of its
/// kind, as far as that is known, has started there.
bool answers_at_next(session::Session& session, std::uint8_t node, const OwedRestart& owed,
                     bool has_started_there) {
  const auto next = next_node_id(owed.values, owed.node_id);
  if (!next || *next == node) return false;
  const auto there = session::read_identity(session, *next);
  if (!there) return false;
  const bool knows_kind = owed.identity.device_type || owed.identity.product_code;
  return is_same(owed.identity, *there) ||
         (has_started_there && knows_kind && !is_other(owed.identity, *there));
}

}  // namespace

Owing owing(session::Session& session, std::uint8_t node, const OwedRestart& owed, bool has_started_at_next) {
  const session::OptionScope once(session, &session::Options::retries, 0U);
  const auto here = session::read_identity(session, node);
  if (!here) {
    const bool silent = here.error().code == Errc::timeout;
    return silent && answers_at_next(session, node, owed, has_started_at_next) ? Owing::over : Owing::waits;
  }
  if (is_other(owed.identity, *here)) return Owing::of_another;
  const auto bitrate = owed.bus_bitrate ? session::bitrate_of(session.url()) : std::nullopt;
  return bitrate && *bitrate != *owed.bus_bitrate && is_same(owed.identity, *here) ? Owing::over
                                                                                   : Owing::waits;
}

OwedRestart owed_restart(session::Session& session, const fs::path& state_folder, std::uint8_t node) {
  const OwedRestartFile file(state_folder, session.url(), node);
  auto kept = file.read();
  if (!kept) {
    OwedRestart out;
    out.unread = kept.error();
    return out;
  }
  if (!*kept) return {};
  const auto owing = show::owing(session, node, **kept);
  if (owing == Owing::over) file.remove();
  if (owing != Owing::waits) return {};
  // What it does not hold any more, a restart has taken, or somebody else.
  std::erase_if((*kept)->values, [&](const OwedValue& value) {
    const auto holds = session.upload(node, value.object);
    return holds && *holds != value.stored;
  });
  return std::move(**kept);
}

std::string_view owed_lead(const std::vector<OwedValue>& values) {
  return std::ranges::all_of(values, &OwedValue::kept) ? "stored, in force after a restart"
                                                       : "written, in force after a restart";
}

std::string owed_text(const drive::Profile* profile, std::uint8_t node, const std::vector<OwedValue>& values,
                      bool chinese) {
  std::string out;
  for (const auto& value : values) {
    const auto target = drive::target_at(profile, value.object);
    const auto stored = value_text(target, node, value.stored, chinese);
    const auto name = owed_name(profile, value.object);
    append(out,
           value.in_force ? formatted("{} = {} ({} in force)", name, stored,
                                      value_text(target, node, *value.in_force, chinese))
                          : formatted("{} = {}", name, stored),
           ", ");
  }
  return out;
}

std::vector<std::string> owed_names(const drive::Profile* profile, const std::vector<OwedValue>& values) {
  std::vector<std::string> out;
  for (const auto& value : values) out.push_back(owed_name(profile, value.object));
  return out;
}

report::List owed_records(const drive::Profile* profile, const std::vector<OwedValue>& values) {
  report::List out;
  for (const auto& value : values) {
    const auto target = drive::target_at(profile, value.object);
    out.emplace_back(Record{{"index", std::uint64_t{value.object.index}},
                            {"sub", std::uint64_t{value.object.sub}},
                            {"id", target.parameter != nullptr ? Value(target.parameter->id) : Value()},
                            {"in_force", hex_or_null(value.in_force)},
                            {"stored", to_hex(value.stored)}});
  }
  return out;
}

std::string owed_notice(const Desk& desk, std::uint8_t node, const OwedRestart& owed) {
  if (owed.unread)
    return formatted("node {}: what waits for a restart is not known: {}; {}", node,
                     owed.unread->message.text(), owed.unread->hint.text());
  if (owed.values.empty()) return {};
  const auto what = owed_text(desk.profile, node, owed.values, desk.speaks_chinese());
  const bool kept = std::ranges::all_of(owed.values, &OwedValue::kept);
  const auto says = desk.session->modbus() == nullptr ? "status" : "info";
  if (desk.session->can() != nullptr && !owed.by_power)
    return kept
               ? formatted(
                     "node {0}: stored, in force after a restart: {1}; `nmt reset -n {0} --wait` restarts it, "
                     "`{2} --restarted -n {0}` says that it was",
                     node, what, says)
               : formatted(
                     "node {0}: written, in force after a restart, which may lose it unless it is stored first "
                     "(`store`): {1}; `nmt reset -n {0} --wait` restarts it, `{2} --restarted -n {0}` says "
                     "that it was",
                     node, what, says);
  return kept
             ? formatted(
                   "node {0}: stored, in force after a restart: {1}; switch it off and on, then "
                   "`{2} --restarted -n {0}`",
                   node, what, says)
             : formatted(
                   "node {0}: written, in force after a restart, which may lose it unless it is stored first "
                   "(`store`): {1}; switch it off and on, then `{2} --restarted -n {0}`",
                   node, what, says);
}

}  // namespace servoctl::show
