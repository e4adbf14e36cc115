#include "cabinet/cabinet_text.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "drive/drive_settings.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "pdo/pdo_changing.hpp"
#include "pdo/pdo_recipes.hpp"
#include "report/catalogue.hpp"
#include "report/chinese_marks.hpp"
#include "session/measure.hpp"
#include "session/open_port.hpp"
#include "session/pdo_setup.hpp"
#include "session/snapshot.hpp"
#include "settings/backup_formats.hpp"
#include "settings/comparison.hpp"

namespace servoctl::cabinet {
namespace {

/// As a string of TOML.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

bool is_whole_number(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  return !text.empty() && text.size() <= 18 &&
         text.find_first_not_of("0123456789") == std::string_view::npos &&
         (text == "0" || text.front() != '0');
}

bool is_bare_key(std::string_view name) {
  return name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
         std::string_view::npos;
}

std::string line_of(const show::Desk& desk, std::uint8_t node, ObjectAddress object, const Bytes& data) {
  const auto words = settings::worded_value(desk.profile, node, object, data);
  const auto target = drive::target_at(desk.profile, object);
  const auto* parameter = target.parameter;
  const auto label = settings::comment_text(parameter == nullptr ? target.label()
                                            : desk.chinese       ? parameter->name_zh
                                                                 : parameter->name);
  const auto key = is_bare_key(words.name) ? words.name : in_quotes(words.name);
  const auto value = is_whole_number(words.value) ? words.value : in_quotes(words.value);
  return formatted("{} = {}{}", key, value, label.empty() ? "" : "  # " + label);
}

std::string who(const session::Identity& identity, bool chinese) {
  const auto say = [chinese](const std::string& english) {
    return chinese ? report::in_chinese(english) : english;
  };
  std::string out;
  if (identity.device_name.size() > 1) append(out, settings::comment_text(identity.device_name));
  if (identity.vendor_id.value_or(0) != 0)
    append(out, say(formatted("vendor 0x{:08X}", *identity.vendor_id)));
  if (identity.product_code.value_or(0) != 0)
    append(out, say(formatted("product 0x{:08X}", *identity.product_code)));
  if (!identity.software_version.empty())
    append(out, say(formatted("software {}", settings::comment_text(identity.software_version))));
  return chinese ? report::chinese_marks(out) : out;
}

/// A comment of the file, in the language of who reads.
std::string_view comment(std::string_view english, bool chinese) {
  return chinese ? report::chinese_word(english) : english;
}

std::string family_lines(const FoundAxis& axis, bool chinese) {
  if (axis.family.empty())
    return std::string(comment(
               "# No family fits: name one (`servoctl drives`) or an .eds or .xml file, and take the # away.\n",
               chinese)) +
           "# family = \"\"\n";
  auto out = formatted("family = {}", in_quotes(axis.family));
  if (axis.guessed)
    out +=
        axis.others.empty()
            ? std::string(comment("  # guessed by its identity: does the nameplate agree?", chinese))
            : formatted(fmt::runtime(comment("  # guessed by its identity, which fits {} as well", chinese)),
                        one_of(axis.others).text());
  return out + "\n";
}

std::string axis_text(const std::string& bus, const FoundAxis& axis, bool chinese) {
  const bool unknown = axis.family.empty();
  const std::string mark = unknown ? "# " : "";
  auto out = formatted("\n{0}[axis.{1}]", mark, axis.name);
  if (const auto told = who(axis.identity, chinese); !told.empty()) out += "  # " + told;
  out += formatted("\n{0}bus = {1}\n{0}node = {2}\n{3}", mark, in_quotes(bus), axis.node,
                   family_lines(axis, chinese));
  if (unknown) return out;
  if (axis.identity.serial.value_or(0) != 0)
    out += formatted("serial = \"0x{:08X}\"\n", *axis.identity.serial);
  out +=
      axis.increments
          ? formatted(
                fmt::runtime(comment(
                    "# The drive tells its {} increments of 6064h per motor revolution: `turn` is not needed.\n",
                    chinese)),
                *axis.increments)
          : std::string(comment(
                "# turn = 131072            # increments of 6064h per motor revolution: the drive does not tell them\n",
                chinese));
  out += comment("# gear = \"10:1\"            # motor to output\n", chinese);
  out += comment("# per_turn = \"20 mm\"       # what the load moves in one turn of the output\n", chinese);
  out += "# limits = { speed = \"300rpm\", torque = \"80%\" }\n";
  if (axis.heartbeat_ms) out += formatted("heartbeat = \"{}ms\"\n", *axis.heartbeat_ms);
  if (!axis.pdo_file.empty()) out += formatted("pdos = {}\n", in_quotes(axis.pdo_file));
  if (axis.parameters.empty()) return out;
  out += formatted("[axis.{}.parameters]\n", axis.name);
  for (const auto& line : axis.parameters) out += line + "\n";
  return out;
}

/// Settings of which nobody knows whether they can be written are nothing for the file.
bool goes_into_file(const drive::DriveSetting& setting) { return setting.is_writable; }

std::size_t count_undecided(const drive::Profile& profile) {
  const auto all = drive::settings_of(profile);
  return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [](const auto& setting) {
    return !setting.is_writable && setting.left_out.empty();
  }));
}

}  // namespace

Result<FoundSettings> find_settings(show::Desk& desk, std::uint8_t node) {
  FoundSettings out;
  const std::uint8_t nodes[] = {node};
  const auto snapshot =
      std::move(session::take_snapshots(*desk.session, *desk.profile, nodes, goes_into_file).front());
  if (!snapshot) return fail(snapshot.error());
  const auto factory = settings::factory_side(*desk.profile, node);
  out.unstated = count_undecided(*desk.profile);
  bool other_pdos = false;
  for (const auto& entry : snapshot->entries) {
    const auto usual = factory.values.find(entry.object);
    if (!entry.bytes || !entry.left_out.empty() || settings::is_address(desk.profile, entry.object)) continue;
    if (usual == factory.values.end()) ++out.unstated;
    if (usual == factory.values.end() || *entry.bytes == usual->second) continue;
    if (drive::is_of_pdos(*desk.profile, entry.object))
      other_pdos = true;
    else if (entry.object == objects::kProducerHeartbeat)
      out.heartbeat_ms = static_cast<std::uint16_t>(load_le(*entry.bytes));
    else
      out.parameters.push_back(line_of(desk, node, entry.object, *entry.bytes));
  }
  const session::MeasureQuestion question[] = {{node, drive::Measure::increments_per_turn}};
  if (const auto turn = session::read_measures(*desk.session, *desk.profile, question).front())
    out.increments = turn->value;
  if (!other_pdos) return out;
  const auto values = std::move(session::read_pdo_values(*desk.session, desk.profile, nodes).front());
  if (!values) return fail(values.error());
  const pdo::PresentPdos present{node, *values, session::pdos_of(*values)};
  const auto saved = pdo::saved_pdos(desk, present);
  out.pdos = pdo::pdo_toml(saved.file, saved.names);
  return out;
}

std::string cabinet_text(const std::string& bus, const std::string& url, const std::vector<FoundAxis>& axes,
                         bool whole, bool chinese) {
  std::string out;
  if (whole)
    out +=
        std::string(comment(
            "# What stands in the cabinet, and what each drive is to have. `servoctl cabinet check` reads this file\n"
            "# without a bus, `cabinet plan` shows what differs from the drives, `cabinet apply` makes it so.\n"
            "# Give the axes the names of your machine: `servoctl status feeder`. Values that axes share go into\n"
            "# [group.NAME] (an axis says group = \"NAME\") or [family.NAME].\n",
            chinese)) +
        "format = 1\n\n";
  else
    out += "\n";
  out += formatted("[bus.{}]\nurl = {}\n", bus, in_quotes(url));
  if (whole && !session::is_ethercat(url)) out += "# bitrate = \"500k\"\n";
  for (const auto& axis : axes) out += axis_text(bus, axis, chinese);
  return out;
}

}  // namespace servoctl::cabinet
