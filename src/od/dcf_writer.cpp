#include <unordered_map>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/dcf.hpp"
#include "od/eds.hpp"
#include "od/eds_compact.hpp"
#include "od/eds_keys.hpp"
#include "od/eds_section.hpp"
#include "od/eds_value.hpp"
#include "od/ini.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

class Writer {
 public:
  Writer(std::string_view text, const EdsFile& file, const DcfSettings& settings)
      : ini_(parse_ini(text)), settings_(&settings) {
    mend_keys(ini_);
    for (const auto& object : file.dictionary.objects())
      for (const auto& entry : object.entries)
        if (const auto value = settings.values.find(entry.address); value != settings.values.end())
          texts_[entry.line].emplace_back(entry.address, eds_text(entry.type, value->second));
  }

  std::string write() {
    for (const auto& section : ini_.sections) add(section);
    if (!commissioned_) add_commissioning();
    return std::move(out_);
  }

 private:
  void add(const IniSection& section) {
    const auto name = parse_section_name(section.name);
    const auto kind = name ? name->kind : SectionKind::other;
    if (kind == SectionKind::commissioning || kind == SectionKind::values) return;
    begin(section.name);
    if (equals_nocase(section.name, "FileInfo"))
      add_file_info(section);
    else
      for (const auto& key : section.keys)
        if (!equals_nocase(key.key, "ParameterValue")) line(key.key, key.value);
    const bool object = kind == SectionKind::object || kind == SectionKind::sub;
    if (const auto found = texts_.find(section.line); object && found != texts_.end())
      add_values(section, found->second);
    if (kind == SectionKind::device_info) add_commissioning();
  }

  void add_values(const IniSection& section,
                  const std::vector<std::pair<ObjectAddress, std::string>>& texts) {
    if (!has_compact_subs(section)) {
      line("ParameterValue", texts.front().second);
      return;
    }
    begin(formatted("{:04X}Value", texts.front().first.index));
    line("NrOfEntries", formatted("{}", texts.size()));
    for (const auto& [object, text] : texts) line(formatted("{}", object.sub), text);
  }

  void add_file_info(const IniSection& section) {
    std::string_view eds;
    for (const auto& key : section.keys) {
      const auto is = [&](std::string_view name) { return equals_nocase(key.key, name); };
      if (is("FileName")) eds = key.value;
      const bool dated = !settings_->date.empty() && (is("ModificationDate") || is("ModificationTime"));
      if (!is("FileName") && !is("LastEDS") && !dated) line(key.key, key.value);
    }
    line("FileName", settings_->file_name);
    line("LastEDS", eds);
    if (settings_->date.empty()) return;
    line("ModificationDate", settings_->date);
    line("ModificationTime", settings_->time);
  }

  void add_commissioning() {
    if (commissioned_) return;
    commissioned_ = true;
    begin("DeviceComissioning");
    line("NodeID", formatted("{}", settings_->node_id));
    line("NodeName", settings_->node_name);
    if (settings_->kbps) line("Baudrate", formatted("{}", *settings_->kbps));
    line("NetNumber", "1");
    line("NetworkName", "");
    line("CANopenManager", "0");
  }

  void begin(std::string_view section) { out_ += formatted("{}[{}]\n", out_.empty() ? "" : "\n", section); }
  void line(std::string_view key, std::string_view value) { out_ += formatted("{}={}\n", key, value); }

  IniText ini_;
  const DcfSettings* settings_;
  /// By the line of the section that describes the entries: one, or all of a CompactSubObj.
  std::unordered_map<std::uint32_t, std::vector<std::pair<ObjectAddress, std::string>>> texts_;
  std::string out_;
  bool commissioned_ = false;
};

}  // namespace

Result<std::string> write_dcf(std::string_view eds, const DcfSettings& settings) {
  const auto file = read_eds(eds, "the data sheet");
  if (!file) return fail(file.error());
  const auto decoded = to_utf8(eds);
  return Writer(decoded.text(eds), *file, settings).write();
}

}  // namespace servoctl::od
