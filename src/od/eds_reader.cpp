#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_compact.hpp"
#include "od/eds_object.hpp"
#include "od/eds_section.hpp"
#include "od/eds_value.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

class Reader {
 public:
  Reader(std::string_view text, Findings findings) : ini_(parse_ini(text)), findings_(std::move(findings)) {}

  EdsFile read() {
    tell_strays();
    for (const auto& section : ini_.sections) take_section(section);
    if (device_info_ != nullptr) read_device(*device_info_);
    if (dummies_ != nullptr) read_dummies(*dummies_);
    if (commissioning_ != nullptr) read_node_id(*commissioning_);
    read_objects();
    if (device_info_ != nullptr) add_compact_pdos(*device_info_, out_.dictionary, findings_);
    check_lists();
    out_.diagnostics = findings_.take();
    return std::move(out_);
  }

 private:
  using ListKey = std::pair<std::uint16_t, SectionKind>;

  void tell_strays() {
    for (const auto& stray : ini_.strays) {
      const auto text = stray.text;
      if (text.starts_with("<<<<<<<") || text.starts_with("=======") || text.starts_with(">>>>>>>")) {
        findings_.add(Severity::error, stray.line, 1, "merge-marker",
                      fmt::format("'{}' is left from a merge", shown(text)), "finish the merge");
      } else if (text.starts_with("#") || text.starts_with("//")) {
        findings_.add(Severity::warning, stray.line, 1, "foreign-comment",
                      fmt::format("'{}' is no comment of this format; skipped", shown(text)),
                      "begin it with ;");
      } else if (!findings_.enough_of("stray-line")) {
        findings_.add(Severity::error, stray.line, 1, "stray-line",
                      fmt::format("'{}' is neither a section nor a key", shown(text)),
                      "remove the line, or begin it with ; when it is a comment");
      }
    }
  }

  void take_section(const IniSection& section) {
    check_duplicate_keys(section, findings_);
    if (!section.closed && !findings_.enough_of("unclosed-section"))
      findings_.add(Severity::warning, section.line, 1, "unclosed-section",
                    fmt::format("[{} has no ]", shown(section.name)), "close the name with ]");
    auto name = parse_section_name(section.name);
    if (!name) name = respelt(section);
    if (!name) return;
    switch (name->kind) {
      case SectionKind::object:
      case SectionKind::sub: places_.push_back({*name, &section}); break;
      case SectionKind::list: lists_.push_back(&section); break;
      case SectionKind::device_info: take_once(device_info_, section); break;
      case SectionKind::commissioning: take_once(commissioning_, section); break;
      case SectionKind::dummies: take_once(dummies_, section); break;
      case SectionKind::names:
      case SectionKind::values:
      case SectionKind::denotations: take_once(compact_lists_[{name->index, name->kind}], section); break;
      case SectionKind::other: break;
    }
  }

  /// A name the standard does not have: read as what it is likely meant for, or told as unknown.
  std::optional<SectionName> respelt(const IniSection& section) {
    if (findings_.enough_of("unknown-section") || findings_.enough_of("misspelt-section"))
      return std::nullopt;
    const auto meant = respelt_section_name(section.name);
    if (meant)
      findings_.add(Severity::warning, section.line, 1, "misspelt-section",
                    fmt::format("[{}] is taken as [{}]", shown(section.name), *meant),
                    fmt::format("write [{}]", *meant));
    else
      findings_.add(Severity::warning, section.line, 1, "unknown-section",
                    fmt::format("[{}] is no section of CiA 306", shown(section.name)),
                    "correct its name, or remove it");
    return meant ? parse_section_name(*meant) : std::nullopt;
  }

  void take_once(const IniSection*& place, const IniSection& section) {
    if (place == nullptr)
      place = &section;
    else
      tell_duplicate(section, *place, findings_);
  }

  void read_device(const IniSection& section) {
    const auto text = [&](std::string_view name) {
      const auto* key = section.find(name);
      return key == nullptr ? std::string() : std::string(key->value);
    };
    const auto number = [&](std::string_view name) -> std::uint32_t {
      const auto* key = section.find(name);
      if (key == nullptr || key->value.empty()) return 0;
      return static_cast<std::uint32_t>(eds_number(*key, 0xFFFF'FFFFU, findings_).value_or(0));
    };
    auto& device = out_.device;
    device.vendor_name = text("VendorName");
    device.product_name = text("ProductName");
    device.vendor_number = number("VendorNumber");
    device.product_number = number("ProductNumber");
    device.revision_number = number("RevisionNumber");
    for (const std::uint32_t rate : {10U, 20U, 50U, 100U, 125U, 250U, 500U, 800U, 1000U})
      if (number(fmt::format("BaudRate_{}", rate)) == 1) device.bitrates.push_back(rate);
  }

  void read_dummies(const IniSection& section) {
    for (std::uint64_t code = 1; code <= 7; ++code) {
      const auto* key = section.find(fmt::format("Dummy{:04X}", code));
      if (key == nullptr || key->value.empty() || eds_number(*key, 1, findings_).value_or(0) == 0) continue;
      out_.device.dummies.push_back(data_type_from_cia(code).value_or(DataType::boolean));
    }
  }

  void read_node_id(const IniSection& section) {
    constexpr std::uint64_t kUnconfigured = 255;
    const auto* key = section.find("NodeID");
    if (key == nullptr || key->value.empty()) return;
    const auto id = eds_number(*key, kUnconfigured, findings_).value_or(0);
    if (id <= 127)
      out_.node_id = static_cast<std::uint8_t>(id);
    else if (id != kUnconfigured)
      findings_.error(*key, "bad-number", fmt::format("NodeID: {} is no node-ID", id), "write 1 to 127");
  }

  void read_objects() {
    const auto by_index = [](const ObjectSection& a, const ObjectSection& b) {
      return a.name.index < b.name.index;
    };
    if (!std::is_sorted(places_.begin(), places_.end(), by_index))
      std::stable_sort(places_.begin(), places_.end(), by_index);
    for (auto first = places_.begin(); first != places_.end();) {
      const auto index = first->name.index;
      const auto last = std::find_if(first, places_.end(),
                                     [&](const ObjectSection& place) { return place.name.index != index; });
      const auto sections = group_sections(std::span(first, last), findings_);
      const CompactLists lists{list(index, SectionKind::names), list(index, SectionKind::values),
                               list(index, SectionKind::denotations), compact_left_};
      auto object = eds_object(index, sections, lists, out_.notes, findings_);
      if (object.entries.size() > sections.subs.size() + 1)
        compact_left_ -= std::min(compact_left_, object.entries.size() - sections.subs.size());
      if (!object.entries.empty()) out_.dictionary.add(std::move(object));
      present_.emplace_back(index, sections.main);
      first = last;
    }
  }

  const IniSection* list(std::uint16_t index, SectionKind kind) const {
    const auto found = compact_lists_.find({index, kind});
    return found == compact_lists_.end() ? nullptr : found->second;
  }

  bool is_present(std::uint64_t index) const {
    const auto found = std::lower_bound(present_.begin(), present_.end(), index,
                                        [](const auto& entry, std::uint64_t i) { return entry.first < i; });
    return (found != present_.end() && found->first == index) ||
           out_.dictionary.object(static_cast<std::uint16_t>(index)) != nullptr;
  }

  /// The index that a line of a list means, when there is such an object.
  std::optional<std::uint64_t> listed_index(const IniKey& key) {
    const auto index = eds_number(key, 0xFFFF, findings_);
    if (!index || is_present(*index)) return index;
    const auto hex = parse_digits(key.value, 16);
    const bool meant_hex = hex && *hex <= 0xFFFF && is_present(*hex);
    if (meant_hex)
      findings_.warn(key, "decimal-index", fmt::format("{} is taken as 0x{:04X}", key.value, *hex),
                     fmt::format("write 0x{:04X}: without 0x a number is decimal", *hex));
    else if (!findings_.enough_of("listed-but-absent"))
      findings_.error(key, "listed-but-absent", fmt::format("0x{:04X} is listed and has no section", *index),
                      "add the section, or take it off the list");
    return meant_hex ? hex : index;
  }

  void check_lists() {
    std::vector<bool> listed(0x10000);
    for (const auto* section : lists_) {
      const IniKey* count = nullptr;
      for (const auto& key : section->keys) {
        if (equals_nocase(key.key, "SupportedObjects"))
          count = &key;
        else if (const auto index = key.value.empty() ? std::nullopt : listed_index(key))
          listed[*index] = true;
      }
      check_count(section->keys.size(), count);
    }
    if (lists_.empty()) return;
    for (const auto& object : present_)
      if (object.second != nullptr && !listed[object.first])
        findings_.add(Severity::warning, object.second->line, 1, "not-listed",
                      fmt::format("[{}] is in none of the lists of objects", object.second->name),
                      "add it to MandatoryObjects, OptionalObjects or ManufacturerObjects");
  }

  void check_count(std::size_t keys, const IniKey* count) {
    if (count == nullptr || count->value.empty()) return;
    const auto number = eds_number(*count, 0xFFFF, findings_);
    if (number && *number != keys - 1)
      findings_.warn(*count, "wrong-object-count",
                     fmt::format("SupportedObjects is {}, but {} follow", *number, keys - 1),
                     fmt::format("write SupportedObjects={}", keys - 1));
  }

  IniText ini_;
  Findings findings_;
  EdsFile out_;
  const IniSection* device_info_ = nullptr;
  const IniSection* commissioning_ = nullptr;
  const IniSection* dummies_ = nullptr;
  std::vector<const IniSection*> lists_;
  std::size_t compact_left_ = 100'000;  ///< Entries that CompactSubObj may still make.
  std::map<ListKey, const IniSection*> compact_lists_;
  std::vector<ObjectSection> places_;
  std::vector<std::pair<std::uint16_t, const IniSection*>> present_;  ///< In rising index.
};

Findings findings_of(const DecodedText& decoded) {
  Findings findings;
  const auto at = [&](std::string_view rule, std::string message, std::string remedy) {
    findings.add(Severity::warning, decoded.line, decoded.column, rule, std::move(message),
                 std::move(remedy));
  };
  if (decoded.encoding != TextEncoding::utf8 || decoded.replaced_bytes > 0)
    at("encoding",
       fmt::format("the file is taken as {}{}", name(decoded.encoding),
                   decoded.replaced_bytes == 0
                       ? std::string()
                       : fmt::format("; {} places in it mean nothing", decoded.replaced_bytes)),
       "save it as UTF-8");
  if (decoded.skipped_nuls > 0)
    at("nul-byte", fmt::format("{} NUL bytes are skipped", decoded.skipped_nuls), "remove them");
  return findings;
}

tl::unexpected<Error> refuse(std::string_view file, std::string_view why, std::string hint) {
  return fail(Errc::file, fmt::format("{}: {}", file, why), std::move(hint));
}

std::size_t count_of(const std::vector<Diagnostic>& diagnostics, Severity severity) {
  std::size_t count = 0;
  for (const auto& diagnostic : diagnostics) count += diagnostic.severity == severity ? diagnostic.count : 0;
  return count;
}

}  // namespace

std::size_t EdsFile::error_count() const { return count_of(diagnostics, Severity::error); }
std::size_t EdsFile::warning_count() const { return count_of(diagnostics, Severity::warning); }

Result<EdsFile> read_eds(std::string_view text, std::string_view file) {
  constexpr std::string_view kHint = "is it an EDS or DCF file (CiA 306)?";
  if (text.size() > kMostEdsBytes)
    return refuse(file, fmt::format("{} MiB are too many for an EDS", text.size() >> 20U),
                  std::string(kHint));
  if (is_binary(text)) return refuse(file, "this is no text", std::string(kHint));
  const auto decoded = to_utf8(text);
  auto out = Reader(decoded.text(text), findings_of(decoded)).read();
  if (!out.dictionary.empty()) return out;
  return refuse(file, "there is no usable object in this file",
                out.diagnostics.empty() ? std::string(kHint) : to_string(out.diagnostics.front(), file));
}

std::string to_string(const Diagnostic& diagnostic, std::string_view file) {
  return fmt::format("{}:{}:{}: {}: {} [{}]", file, diagnostic.line, diagnostic.column,
                     diagnostic.severity == Severity::error ? "error" : "warning", diagnostic.message,
                     diagnostic.rule);
}

}  // namespace servoctl::od
