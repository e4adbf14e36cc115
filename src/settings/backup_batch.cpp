#include <algorithm>
#include <cctype>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "session/pdo_change.hpp"
#include "session/write_plan.hpp"
#include "settings/backup_formats.hpp"
#include "settings/comparison.hpp"
#include "show/reading.hpp"

namespace servoctl::settings {
namespace {

std::string in_quotes(std::string_view word) {
  std::string out = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\' || c == '$') out += '\\';
    out += c;
  }
  return out + '"';
}

/// A word as a batch file takes it: in quotes where it has anything but letters, digits and plain signs.
std::string quoted(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 ||
           std::string_view("+-._:/").find(static_cast<char>(c)) != std::string_view::npos;
  };
  return !word.empty() && std::all_of(word.begin(), word.end(), plain) ? word : in_quotes(word);
}

/// A number, or bytes in hexadecimal: what no reader takes for an option.
bool is_harmless(std::string_view text) {
  if (text.starts_with("hex:")) return true;
  if (text.starts_with('-')) text.remove_prefix(1);
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0;
}

/// Whether the number of a parameter is a word for itself and no option, as those of our tables are.
bool is_plain_id(std::string_view id) {
  return !id.empty() && std::isalpha(static_cast<unsigned char>(id.front())) != 0 &&
         std::all_of(id.begin(), id.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

/// What the value is called in a line, in a form that gives these bytes again.
std::string value_text(const drive::Meaning& meaning, od::DataType type, ObjectAddress object,
                       const Bytes& data) {
  const auto value = od::decode(type, data);
  const bool number = od::is_integer(type);
  const auto bits = formatted("0x{:0{}X}", load_le(data), 2 * data.size());
  // COB-IDs, mappings and heartbeat entries are made of fields: decimal says nothing.
  if (number && object.index < 0x2000 && data.size() == 4 && meaning.unit.empty()) return bits;
  const auto same = [&](const std::string& text) {
    const auto parsed = drive::parse_quantity(meaning, text);
    const auto bytes = parsed ? od::encode(meaning.type, *parsed) : Result<Bytes>(Bytes{});
    return parsed && bytes && *bytes == data;
  };
  if (value) {
    auto text = drive::plain_text(meaning, *value);
    const bool plain = number && meaning.encoding == od::Encoding::plain;
    if (fits_a_line(text) && (plain || same(text))) return text;
  }
  return number ? bits : "hex:" + to_hex(data, "");
}

/// The lines of a backup: settings in rising address, each PDO as a procedure.
class Lines {
 public:
  Lines(const drive::Profile& profile, const Backup& backup) : profile_(&profile), backup_(&backup) {}

  std::string text() {
    out_ = formatted(
        "# Settings of node {} ({}), saved by {} at {} from {}.\n"
        "# `servoctl run` writes them into the drive, `restore` as well and with more care. They are not "
        "stored:\n# add `store --yes` when they are to survive power-off.\ndrive {}\nuse {}\n",
        backup_->identity.node, comment_text(backup_->family), comment_text(backup_->tool),
        comment_text(backup_->time), comment_text(backup_->bus), batch_word(backup_->family),
        backup_->identity.node);
    add_values();
    for (const auto& entry : backup_->entries)
      if (!entry.bytes)
        out_ += formatted("# left out: {} {} ({})\n", to_string(entry.object), comment_text(entry.name),
                          comment_text(entry.left_out));
    return std::move(out_);
  }

 private:
  void add_values() {
    session::Values wanted;
    std::string comments;
    for (const auto& entry : backup_->entries) {
      if (!entry.bytes) continue;
      const auto why = reason_to_comment(entry);
      if (why.empty())
        wanted.emplace(entry.object, *entry.bytes);
      else
        comments += formatted("# {}: {}\n", why, line(entry.object, *entry.bytes));
    }
    add_writes(wanted);
    out_ += comments;
  }

  /// Why the line of a value is only shown; empty when it is one to be run.
  std::string reason_to_comment(const Backup::Entry& entry) const {
    if (is_address(profile_, entry.object)) return "for a drive that takes this one's place on the bus";
    if (!may_be_written(profile_, entry.object)) return std::string(kNotKnownWritable);
    const auto range = range_missed(*profile_, backup_->identity.node, entry.object, *entry.bytes);
    return range.empty() ? range : formatted("the drive's own value, outside of the limits {}", range);
  }

  /// Nothing is known of the drive the lines will meet.
  void add_writes(const session::Values& wanted) {
    const auto plan = session::plan_writes_for_any_drive(wanted);
    if (session::needs_pre_operational(profile_, plan))
      out_ += "nmt preop  # Its PDOs change outside operational alone; `nmt start` goes back\n";
    for (const auto& step : plan) add(step.object, step.data);
  }

  std::string line(ObjectAddress object, const Bytes& data) const {
    return write_line(profile_, backup_->identity.node, object, data);
  }
  void add(ObjectAddress object, const Bytes& data) {
    out_ += commented_line(profile_, backup_->identity.node, object, data) + "\n";
  }

  const drive::Profile* profile_;
  const Backup* backup_;
  std::string out_;
};

}  // namespace

bool may_be_written(const drive::Profile* profile, ObjectAddress object) {
  const auto* entry = drive::target_at(profile, object).entry;
  return entry == nullptr || od::writable(entry->access);
}

std::string range_missed(const drive::Profile& profile, std::uint8_t node, ObjectAddress object,
                         const Bytes& data) {
  const auto meaning = drive::fitted(drive::meaning(drive::target_at(&profile, object), node), data.size());
  const auto value = od::decode(meaning.type, data);
  return !value || drive::check_limits(meaning, *value) ? std::string() : drive::range_text(meaning);
}

std::string batch_word(const std::string& word) { return quoted(word); }

bool fits_a_line(std::string_view text) { return is_utf8(text) && printable(text) == text; }

std::string comment_text(std::string_view text) {
  std::string out(text);
  for (auto& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7F) c = ' ';
  // A line that ends in a backslash goes on in the next.
  while (!out.empty() && (out.back() == '\\' || out.back() == ' ')) out.pop_back();
  return out;
}

WordedValue worded_value(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                         const Bytes& data) {
  const auto target = drive::target_at(profile, object);
  const auto meaning = drive::fitted(drive::meaning(target, node), data.size());
  WordedValue out;
  out.type = show::type_of({node, target, {}, data}, data);
  out.value = value_text(meaning, out.type, object, data);
  out.typed = !meaning.type_known || !meaning.size_known;
  out.panel = target.parameter != nullptr && is_plain_id(target.parameter->id);
  out.name = out.panel ? target.parameter->id : to_string(object);
  return out;
}

std::string write_line(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                       const Bytes& data) {
  const auto* parameter = drive::target_at(profile, object).parameter;
  const auto words = worded_value(profile, node, object, data);
  const bool harmless = words.type != od::DataType::string && is_harmless(words.value);
  const bool locked = parameter != nullptr && profile->rules.store.locks(parameter->id);
  const auto options = (words.typed ? formatted(" --type {}", od::name(words.type)) : std::string()) +
                       (locked ? " --unlock" : "");
  const bool set = words.panel && !words.typed;
  const std::string verb = set ? "param set " : "write ";
  // A drive's string may be an option to the letter.
  if (!harmless) return formatted("{}{}{} -- {}", verb, words.name, options, in_quotes(words.value));
  return formatted("{}{}{}{}{}", verb, words.name, set ? '=' : ' ', quoted(words.value), options);
}

std::string commented_line(const drive::Profile* profile, std::uint8_t node, ObjectAddress object,
                           const Bytes& data) {
  const auto target = drive::target_at(profile, object);
  const auto name = comment_text(target.parameter != nullptr ? target.parameter->name : target.label());
  const auto line = write_line(profile, node, object, data);
  return name.empty() ? line : formatted("{}  # {}", line, name);
}

std::string batch_text(const drive::Profile& profile, const Backup& backup) {
  return Lines(profile, backup).text();
}

}  // namespace servoctl::settings
