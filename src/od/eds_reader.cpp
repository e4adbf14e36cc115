#include <algorithm>
#include <map>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_checks.hpp"
#include "od/eds_compact.hpp"
#include "od/eds_keys.hpp"
#include "od/eds_lists.hpp"
#include "od/eds_object.hpp"
#include "od/eds_section.hpp"
#include "od/eds_types.hpp"
#include "od/eds_value.hpp"
#include "od/learned_mark.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

/// `=====`, `===== Motion =====`, `*****`: a ruled line, or words that one begins.
bool is_heading(std::string_view text) {
  const auto is_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (c & 0x80) != 0;
  };
  constexpr std::size_t kShortest = 3;
  if (text.size() < kShortest) return false;
  return text.starts_with("===") || std::none_of(text.begin(), text.end(), is_word);
}

bool has_learned_mark(const IniSection& section) {
  return equals_nocase(trim(section.name), "Comments") &&
         std::any_of(section.keys.begin(), section.keys.end(),
                     [](const IniKey& key) { return trim(key.value).starts_with(kLearnedWord); });
}

class EdsReader {
 public:
  EdsReader(std::string_view text, Findings findings)
      : ini_(parse_ini(text)), findings_(std::move(findings)) {
    mend_keys(ini_, findings_);
  }

  EdsFile read() {
    tell_strays();
    for (const auto& section : ini_.sections) take_section(section);
    out_.learned = std::any_of(ini_.sections.begin(), ini_.sections.end(), has_learned_mark);
    if (device_info_ != nullptr)
      read_device(*device_info_);
    else
      findings_.add(Severity::warning, 1, 1, "missing-device-info", "there is no [DeviceInfo]",
                    "add it, with VendorName, ProductName and the bitrates");
    if (dummies_ != nullptr) read_dummies(*dummies_);
    if (commissioning_ != nullptr) read_node_id(*commissioning_);
    read_objects();
    if (device_info_ != nullptr) add_compact_pdos(*device_info_, out_.dictionary, findings_);
    const PresentObjects present{present_, out_.dictionary};
    check_lists(lists_, present, findings_);
    check_mandatory_objects(present, findings_);
    check_mappings(out_.dictionary, findings_);
    findings_.place(ini_);
    out_.diagnostics = findings_.take();
    return std::move(out_);
  }

 private:
  using ListKey = std::pair<std::uint16_t, SectionKind>;

  /// A line of seven `=` is of a merge only where the other marks are; else it is a heading, as is whatever
  /// begins and ends with signs.
  void tell_strays() {
    const auto is_mark = [](std::string_view text) {
      return text.starts_with("<<<<<<<") || text.starts_with(">>>>>>>");
    };
    const bool merged = std::any_of(ini_.strays.begin(), ini_.strays.end(),
                                    [&](const IniStray& stray) { return is_mark(stray.text); });
    for (const auto& stray : ini_.strays) {
      const auto text = stray.text;
      if (is_mark(text) || (merged && text.starts_with("======="))) {
        findings_.add(Severity::error, stray.line, 1, "merge-marker",
                      formatted("'{}' is left from a merge", shown(text)), "finish the merge");
      } else if (is_heading(text)) {
        continue;
      } else if (text.starts_with("#") || text.starts_with("//")) {
        findings_.add(Severity::warning, stray.line, 1, "foreign-comment",
                      formatted("'{}' is not a comment in this format; skipped", shown(text)),
                      "begin it with ;");
      } else if (!findings_.enough_of("stray-line")) {
        findings_.add(Severity::error, stray.line, 1, "stray-line",
                      formatted("'{}' is neither a section nor a key", shown(text)),
                      "remove the line, or begin it with ; when it is a comment");
      }
    }
  }

  void take_section(const IniSection& section) {
    check_duplicate_keys(section, findings_);
    if (!section.closed && !findings_.enough_of("unclosed-section"))
      findings_.add(Severity::warning, section.line, 1, "unclosed-section",
                    formatted("[{} has no ]", shown(section.name)), "close the name with ]");
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

  /// A name the standard does not have: read as what it is likely meant for. Else it is a section of the
  /// vendor's, and told only where it describes an object.
  std::optional<SectionName> respelt(const IniSection& section) {
    if (findings_.enough_of("unknown-section") || findings_.enough_of("misspelt-section"))
      return std::nullopt;
    const auto meant = respelt_section_name(section.name);
    if (meant)
      findings_.add(Severity::warning, section.line, 1, "misspelt-section",
                    formatted("[{}] is taken as [{}]", shown(section.name), *meant),
                    formatted("write [{}]", *meant));
    else if (describes_object(section))
      findings_.add(Severity::warning, section.line, 1, "unknown-section",
                    formatted("[{}] is not a CiA 306 section; its object is ignored", shown(section.name)),
                    "name it after the index: [2000] or [2000sub1]");
    return meant ? parse_section_name(*meant) : std::nullopt;
  }

  static bool describes_object(const IniSection& section) {
    const auto has = [&](std::string_view key) { return section.find(key) != nullptr; };
    return has("DataType") || has("AccessType") || has("ParameterValue");
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
      if (number(formatted("BaudRate_{}", rate)) == 1) device.bitrates.push_back(rate);
  }

  void read_dummies(const IniSection& section) {
    for (std::uint64_t code = 1; code <= 7; ++code) {
      const auto* key = section.find(formatted("Dummy{:04X}", code));
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
      findings_.error(*key, "bad-number", formatted("NodeID: {} is not a node-ID", id), "write 1 to 127");
  }

  void read_objects() {
    const auto by_index = [](const ObjectSection& a, const ObjectSection& b) {
      return a.name.index < b.name.index;
    };
    if (!std::is_sorted(places_.begin(), places_.end(), by_index))
      std::stable_sort(places_.begin(), places_.end(), by_index);
    const auto types = limit_types(places_);
    for (auto first = places_.begin(); first != places_.end();) {
      const auto index = first->name.index;
      const auto last = std::find_if(first, places_.end(),
                                     [&](const ObjectSection& place) { return place.name.index != index; });
      const auto sections = group_sections(std::span(first, last), findings_);
      const CompactLists lists{list(index, SectionKind::names), list(index, SectionKind::values),
                               list(index, SectionKind::denotations), compact_left_};
      auto object = eds_object(index, sections, lists, types, out_.notes, findings_);
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
  if (decoded.encoding != TextEncoding::utf8 || decoded.odd_bytes > 0)
    at("encoding",
       formatted(
           "the file is taken as {}{}", title(decoded.encoding),
           decoded.odd_bytes == 0
               ? std::string()
               : formatted("; {} bytes mean nothing in it and are written out, as \\xFF", decoded.odd_bytes)),
       "save it as UTF-8");
  if (decoded.skipped_nuls > 0)
    at("nul-byte", formatted("{} NUL bytes are skipped", decoded.skipped_nuls), "remove them");
  return findings;
}

tl::unexpected<Error> refuse(std::string_view file, const Message& why, Message hint) {
  return fail(Errc::file, message("{}: {}", as_it_is(file), why), std::move(hint));
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
    return refuse(file, message("{} MiB is too large for an EDS", text.size() >> 20U), std::string(kHint));
  if (is_binary(text)) return refuse(file, "not a text file", std::string(kHint));
  const auto decoded = to_utf8(text);
  auto out = EdsReader(decoded.text(text), findings_of(decoded)).read();
  if (!out.dictionary.empty()) return out;
  if (decoded.text(text).find("<EtherCATInfo") != std::string_view::npos)
    return refuse(
        file, "this is an ESI (EtherCATInfo), not an EDS or DCF file",
        "it describes objects and has no values: it can be named with -d, and checked by `eds check`");
  if (starts_with_nocase(trim(decoded.text(text)), "<"))
    return refuse(file, "this is XML, not an EDS or DCF file",
                  "XML device descriptions (XDD and XDC, CiA 311) are not supported: use the device's EDS");
  const auto& all = out.diagnostics;
  const auto why = std::find_if(
      all.begin(), all.end(), [](const Diagnostic& finding) { return finding.severity == Severity::error; });
  return refuse(file, "there is no usable object in this file",
                why == all.end() ? Message(kHint)
                                 : message("{}:{}:{}: {}: {} [{}]", as_it_is(file), why->line, why->column,
                                           "error", why->message, as_it_is(why->rule)));
}

std::string to_string(const Diagnostic& diagnostic, std::string_view file) {
  return formatted("{}:{}:{}: {}: {} [{}]", file, diagnostic.line, diagnostic.column,
                   diagnostic.severity == Severity::error ? "error" : "warning", diagnostic.message,
                   diagnostic.rule);
}

}  // namespace servoctl::od
