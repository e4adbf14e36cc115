#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>

#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_entry.hpp"

namespace servoctl::od {
namespace {

constexpr std::array<std::string_view, 3> kLists{"MandatoryObjects", "OptionalObjects",
                                                 "ManufacturerObjects"};
constexpr std::array<std::string_view, 9> kOtherSections{
    "FileInfo", "DeviceInfo",      "DummyUsage",      "Comments", "DeviceComissioning", "DeviceCommissioning",
    "Tools",    "DynamicChannels", "SupportedModules"};

struct SectionName {
  std::uint16_t index = 0;
  std::optional<std::uint8_t> sub;
};

/// `1018` or `1018sub1`; sub-indexes are hexadecimal (CiA 306-1, 4.6.3).
std::optional<SectionName> parse_section_name(std::string_view name) {
  const auto folded = lower(name);
  const auto at = folded.find("sub");
  const auto index = parse_digits(std::string_view(folded).substr(0, at), 16);
  if (!index || *index > 0xFFFF || folded.substr(0, at).size() > 4) return std::nullopt;
  SectionName out{static_cast<std::uint16_t>(*index), std::nullopt};
  if (at == std::string::npos) return out;
  const auto sub = parse_digits(std::string_view(folded).substr(at + 3), 16);
  if (!sub || *sub > 0xFF) return std::nullopt;
  out.sub = static_cast<std::uint8_t>(*sub);
  return out;
}

class Reader {
 public:
  explicit Reader(std::string_view text) : ini_(parse_ini(text)) {}

  EdsFile read() {
    for (const auto& stray : ini_.strays)
      findings_.add(Severity::error, stray.line, 1, "stray-line",
                    fmt::format("'{}' is neither a section nor a key", clip(stray.text, 40)),
                    "remove the line, or begin it with ; when it is a comment");
    read_device();
    sort_sections();
    for (const auto& object : objects_) read_object(object.first, object.second);
    check_lists();
    out_.diagnostics = findings_.take();
    return std::move(out_);
  }

 private:
  struct Sections {
    const IniSection* main = nullptr;
    std::map<std::uint8_t, const IniSection*> subs;
  };

  void read_device() {
    if (const auto* device = ini_.find("DeviceInfo")) {
      const auto text = [&](std::string_view key) {
        const auto* found = device->find(key);
        return found == nullptr ? std::string() : std::string(found->value);
      };
      const auto number = [&](std::string_view key) -> std::uint32_t {
        const auto* found = device->find(key);
        if (found == nullptr || found->value.empty()) return 0;
        return static_cast<std::uint32_t>(eds_number(*found, 0xFFFF'FFFFU, findings_).value_or(0));
      };
      out_.device.vendor_name = text("VendorName");
      out_.device.product_name = text("ProductName");
      out_.device.vendor_number = number("VendorNumber");
      out_.device.product_number = number("ProductNumber");
      out_.device.revision_number = number("RevisionNumber");
      for (const std::uint32_t rate : {10U, 20U, 50U, 100U, 125U, 250U, 500U, 800U, 1000U})
        if (number(fmt::format("BaudRate_{}", rate)) == 1) out_.device.bitrates.push_back(rate);
    }
    // The standard itself spells it with one m.
    for (const auto* name : {"DeviceComissioning", "DeviceCommissioning"}) {
      const auto* section = ini_.find(name);
      const auto* id = section == nullptr ? nullptr : section->find("NodeID");
      if (id != nullptr && !id->value.empty())
        out_.node_id = static_cast<std::uint8_t>(eds_number(*id, 127, findings_).value_or(0));
    }
  }

  void sort_sections() {
    for (const auto& section : ini_.sections) {
      check_doubles(section);
      const auto name = parse_section_name(section.name);
      if (!name) {
        if (!is_known(section.name))
          findings_.add(Severity::warning, section.line, 1, "unknown-section",
                        fmt::format("[{}] is no section of CiA 306", section.name),
                        "correct its name, or remove it");
        continue;
      }
      auto& object = objects_[name->index];
      auto*& place = name->sub ? object.subs[*name->sub] : object.main;
      if (place != nullptr)
        findings_.add(Severity::error, section.line, 1, "duplicate-section",
                      fmt::format("[{}] stands here again, first in line {}; the first one counts",
                                  section.name, place->line),
                      "remove one of them");
      else
        place = &section;
    }
  }

  static bool is_known(std::string_view name) {
    const auto same = [&](std::string_view known) { return equals_nocase(known, name); };
    if (std::any_of(kLists.begin(), kLists.end(), same) ||
        std::any_of(kOtherSections.begin(), kOtherSections.end(), same))
      return true;
    // [1018Name], [1018Value], [1018Denotation], [1018ObjectLinks] belong to an object.
    const auto folded = lower(name);
    return std::any_of(kBelonging.begin(), kBelonging.end(), [&](std::string_view end) {
      return folded.size() > end.size() && folded.ends_with(end) &&
             parse_digits(std::string_view(folded).substr(0, folded.size() - end.size()), 16);
    });
  }

  void check_doubles(const IniSection& section) {
    std::vector<std::pair<std::string, const IniKey*>> seen;
    for (const auto& key : section.keys) seen.emplace_back(lower(key.key), &key);
    std::stable_sort(seen.begin(), seen.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < seen.size(); ++i)
      if (seen[i].first == seen[i - 1].first)
        findings_.warn(*seen[i].second, "duplicate-key",
                       fmt::format("{} stands here again; the last one counts", seen[i].second->key),
                       "remove one of them");
  }

  void read_object(std::uint16_t index, const Sections& sections) {
    if (sections.main == nullptr) {
      const auto* first = sections.subs.begin()->second;
      findings_.add(Severity::error, first->line, 1, "missing-object",
                    fmt::format("[{}] has no section [{:04X}]", first->name, index),
                    "add the section of the object");
    }
    Object object;
    object.index = index;
    if (sections.main != nullptr) read_head(*sections.main, object);
    const bool plain = sections.subs.empty() &&
                       (object.code == ObjectCode::var || object.code == ObjectCode::domain) &&
                       !has_compact(sections.main);
    if (plain && sections.main != nullptr) {
      if (auto entry = eds_entry(*sections.main, {index, 0}, findings_))
        object.entries.push_back(std::move(*entry));
    } else {
      for (const auto& sub : sections.subs)
        if (auto entry = eds_entry(*sub.second, {index, sub.first}, findings_))
          object.entries.push_back(std::move(*entry));
      if (has_compact(sections.main)) read_compact(*sections.main, object);
      check_sub_number(sections, object);
    }
    if (!object.entries.empty()) out_.dictionary.add(std::move(object));
  }

  static bool has_compact(const IniSection* section) {
    const auto* key = section == nullptr ? nullptr : section->find("CompactSubObj");
    return key != nullptr && !key->value.empty() && key->value != "0";
  }

  void read_head(const IniSection& section, Object& object) {
    if (const auto* name = section.find("ParameterName")) object.name = std::string(name->value);
    const auto* code = section.find("ObjectType");
    if (code == nullptr || code->value.empty()) return;  // VAR by the standard.
    const auto number = eds_number(*code, 0xFF, findings_);
    switch (number.value_or(7)) {
      case 0x02: object.code = ObjectCode::domain; break;
      case 0x05: object.code = ObjectCode::deftype; break;
      case 0x06: object.code = ObjectCode::defstruct; break;
      case 0x07: object.code = ObjectCode::var; break;
      case 0x08: object.code = ObjectCode::array; break;
      case 0x09: object.code = ObjectCode::record; break;
      default:
        findings_.error(*code, "unknown-object-type",
                        fmt::format("'{}' is no object type; taken as VAR", code->value),
                        "write 0x7 for a variable, 0x8 for an array, 0x9 for a record");
    }
  }

  /// CompactSubObj: sub 0 and N equal entries, names and values in sections of their own (CiA
  /// 306-1, 4.6.3.3).
  void read_compact(const IniSection& section, Object& object) {
    const auto count = eds_number(*section.find("CompactSubObj"), 254, findings_).value_or(0);
    const auto pattern = eds_entry(section, {object.index, 1}, findings_);
    if (!pattern) return;
    Entry number = *pattern;
    number.address.sub = 0;
    number.name = "Highest sub-index supported";
    number.type = DataType::u8;
    number.access = Access::ro;
    number.pdo = PdoMapping::no;
    number.low = number.high = number.configured = std::nullopt;
    number.default_value = NodeValue{Value(count), false};
    object.entries.push_back(std::move(number));
    const auto* names = ini_.find(fmt::format("{:04X}Name", object.index));
    const auto* values = ini_.find(fmt::format("{:04X}Value", object.index));
    for (std::uint64_t sub = 1; sub <= count; ++sub) {
      Entry entry = *pattern;
      entry.address.sub = static_cast<std::uint8_t>(sub);
      const auto key = fmt::format("{}", sub);
      const auto* name = names == nullptr ? nullptr : names->find(key);
      entry.name = name != nullptr && !name->value.empty() ? std::string(name->value)
                                                           : fmt::format("{}{}", object.name, sub);
      if (const auto* value = values == nullptr ? nullptr : values->find(key))
        entry.default_value = eds_value(value, entry.type, findings_);
      object.entries.push_back(std::move(entry));
    }
  }

  void check_sub_number(const Sections& sections, const Object& object) {
    if (sections.main == nullptr || has_compact(sections.main)) return;
    const auto* key = sections.main->find("SubNumber");
    if (key == nullptr || key->value.empty()) {
      findings_.add(Severity::warning, sections.main->line, 1, "missing-sub-number",
                    fmt::format("[{}] has no SubNumber", sections.main->name),
                    fmt::format("add SubNumber={}", sections.subs.size()));
      return;
    }
    const auto number = eds_number(*key, 256, findings_);
    if (number && *number != sections.subs.size())
      findings_.warn(*key, "wrong-sub-number",
                     fmt::format("SubNumber is {}, but [{:04X}] has {} sub-indexes", *number, object.index,
                                 sections.subs.size()),
                     fmt::format("write SubNumber={}", sections.subs.size()));
  }

  void check_lists() {
    std::map<std::uint16_t, std::uint32_t> listed;
    bool any = false;
    for (const auto name : kLists) {
      const auto* list = ini_.find(name);
      if (list == nullptr) continue;
      any = true;
      for (const auto& key : list->keys) {
        if (equals_nocase(key.key, "SupportedObjects")) continue;
        const auto index = eds_number(key, 0xFFFF, findings_);
        if (!index) continue;
        listed.emplace(static_cast<std::uint16_t>(*index), key.line);
        const auto object = objects_.find(static_cast<std::uint16_t>(*index));
        if (object == objects_.end())
          findings_.error(key, "listed-but-absent",
                          fmt::format("0x{:04X} is listed and has no section", *index),
                          "add the section, or take it off the list");
      }
    }
    for (const auto& object : objects_)
      if (any && object.second.main != nullptr && listed.find(object.first) == listed.end())
        findings_.add(Severity::warning, object.second.main->line, 1, "not-listed",
                      fmt::format("[{}] is in none of the lists of objects", object.second.main->name),
                      "add it to MandatoryObjects, OptionalObjects or ManufacturerObjects");
  }

  static constexpr std::array<std::string_view, 5> kBelonging{"name", "value", "denotation", "objectlinks",
                                                              "subobjlinks"};

  IniText ini_;
  std::map<std::uint16_t, Sections> objects_;
  Findings findings_;
  EdsFile out_;
};

}  // namespace

std::size_t EdsFile::error_count() const {
  return static_cast<std::size_t>(
      std::count_if(diagnostics.begin(), diagnostics.end(),
                    [](const Diagnostic& d) { return d.severity == Severity::error; }));
}

Result<EdsFile> read_eds(std::string_view text, std::string_view file) {
  auto out = Reader(text).read();
  if (!out.dictionary.empty()) return out;
  Error error;
  error.code = Errc::file;
  error.message = fmt::format("{}: there is no usable object in this file", file);
  error.hint = out.diagnostics.empty() ? "is it an EDS or DCF file (CiA 306)?"
                                       : to_string(out.diagnostics.front(), file);
  return fail(std::move(error));
}

std::string to_string(const Diagnostic& diagnostic, std::string_view file) {
  return fmt::format("{}:{}:{}: {}: {} [{}]", file, diagnostic.line, diagnostic.column,
                     diagnostic.severity == Severity::error ? "error" : "warning", diagnostic.message,
                     diagnostic.rule);
}

}  // namespace servoctl::od
