#include <algorithm>
#include <unordered_map>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/dcf.hpp"
#include "od/eds.hpp"
#include "od/eds_compact.hpp"
#include "od/eds_findings.hpp"
#include "od/eds_keys.hpp"
#include "od/eds_section.hpp"
#include "od/eds_value.hpp"
#include "od/ini.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

/// Where a value stands in the text, and whether an entry has taken it.
struct Place {
  const IniSection* section = nullptr;
  const IniKey* key = nullptr;
  bool taken = false;
};

/// Of a value in [1600Value]: the object's index and the number of the line's key.
std::uint32_t list_key(std::uint16_t index, std::uint8_t sub) { return std::uint32_t{index} << 8U | sub; }

class DcfReader {
 public:
  DcfReader(std::string_view text, const EdsFile& eds, std::string_view file)
      : ini_(parse_ini(text)), eds_(&eds), file_(file) {
    mend_keys(ini_);
  }

  Result<Dcf> read() {
    for (const auto& section : ini_.sections) find_places(section);
    if (places_.empty() && out_.unusable.empty())
      return fail(Errc::file, message("{}: it contains no ParameterValue", as_it_is(file_)),
                  "it is a data sheet (EDS), or a DCF in which nothing is configured");
    out_.node_id = eds_->node_id;
    out_.vendor_number = eds_->device.vendor_number;
    out_.product_number = eds_->device.product_number;
    for (const auto& object : eds_->dictionary.objects())
      for (const auto& entry : object.entries) take(entry);
    for (const auto& place : places_)
      if (!place.taken) pass(place);
    std::ranges::sort(out_.unusable, {}, [](const Error& error) { return error.line; });
    return std::move(out_);
  }

 private:
  void find_places(const IniSection& section) {
    const auto name = parse_section_name(section.name);
    if (name && name->kind == SectionKind::values) return find_listed(section, name->index);
    // A section with a name that only resembles one of the standard is found as well.
    for (const auto& key : section.keys) {
      if (!equals_nocase(key.key, "ParameterValue") || key.value.empty()) continue;
      if (sections_.emplace(section.line, places_.size()).second)
        places_.push_back({&section, &key});
      else
        refuse(key.line, message("[{}] has a second ParameterValue", as_it_is(section.name)),
               "remove one of them");
    }
  }

  void find_listed(const IniSection& section, std::uint16_t index) {
    for (const auto& key : section.keys) {
      if (equals_nocase(key.key, "NrOfEntries") || key.value.empty()) continue;
      const auto sub = parse_digits(key.key, 10);
      if (!sub || *sub > 0xFF)
        refuse(key.line,
               message("[{}] has no entry '{}'", as_it_is(section.name), as_it_is(clip(key.key, 40))),
               "its keys are the decimal numbers of sub-indexes");
      else if (listed_.emplace(list_key(index, static_cast<std::uint8_t>(*sub)), places_.size()).second)
        places_.push_back({&section, &key});
      else
        refuse(key.line, message("[{}] has a second entry {}", as_it_is(section.name), *sub),
               "remove one of them");
    }
  }

  /// What the file has for an entry: its own ParameterValue goes before that of a list.
  void take(const Entry& entry) {
    auto* place = place_of(entry);
    if (place == nullptr) return;
    place->taken = true;
    tell_double(entry, *place);
    if (entry.type == DataType::domain) return;
    auto value = entry.configured;
    // Entries of a compact list have theirs already.
    Findings findings;
    if (!value) value = eds_value(place->key, entry.type, findings, ValueUse::written);
    if (value) out_.values.push_back({entry.address, entry.type, *value, place->key->line});
    if (!value) place->taken = false;
  }

  void tell_double(const Entry& entry, const Place& place) {
    const auto listed = listed_.find(list_key(entry.address.index, entry.address.sub));
    if (listed == listed_.end() || &places_[listed->second] == &place) return;
    auto& other = places_[listed->second];
    other.taken = true;
    out_.passed_over.push_back(message(
        "{}:{}: [{}] also has a value of {}, which is ignored in favour of line {}", as_it_is(file_),
        other.key->line, as_it_is(other.section->name), as_it_is(to_string(entry.address)), place.key->line));
  }

  Place* place_of(const Entry& entry) {
    const auto own = sections_.find(entry.line);
    if (own != sections_.end() && !has_compact_subs(*places_[own->second].section))
      return &places_[own->second];
    const auto listed = listed_.find(list_key(entry.address.index, entry.address.sub));
    return listed == listed_.end() ? nullptr : &places_[listed->second];
  }

  /// Of an object with sub-indexes itself, which holds nothing.
  bool is_of_whole(const Place& place) const {
    const auto name = parse_section_name(place.section->name);
    if (!name || name->kind != SectionKind::object) return false;
    const auto& objects = eds_->dictionary.objects();
    return std::any_of(objects.begin(), objects.end(), [&](const Object& object) {
      return object.index == name->index && object.code != ObjectCode::var && !object.entries.empty();
    });
  }

  void pass(const Place& place) {
    if (is_of_whole(place)) {
      out_.passed_over.push_back(message("{}:{}: [{}] has sub-indexes and holds no value of its own",
                                         as_it_is(file_), place.key->line, as_it_is(place.section->name)));
      return;
    }
    const auto first = place.section->line;
    const auto last = place.section->keys.back().line;
    const auto& all = eds_->diagnostics;
    const auto why = std::find_if(all.begin(), all.end(), [&](const Diagnostic& d) {
      return d.severity == Severity::error && d.line >= first && d.line <= last &&
             (d.line == place.key->line || d.rule != "bad-value");
    });
    if (why != all.end()) return refuse(why->line, why->message, why->remedy);
    refuse(place.key->line,
           message("[{}] describes no object that could hold the value", as_it_is(place.section->name)),
           "give the object its section, with DataType and AccessType");
  }

  void refuse(std::uint32_t line, const Message& what, Message hint) {
    auto error = fail(Errc::file, message("{}:{}: {}", as_it_is(file_), line, what), std::move(hint)).value();
    error.line = line;
    out_.unusable.push_back(std::move(error));
  }

  IniText ini_;
  const EdsFile* eds_;
  std::string_view file_;
  Dcf out_;
  std::vector<Place> places_;
  std::unordered_map<std::uint32_t, std::size_t> sections_;  ///< Position in places_ by line of the section.
  std::unordered_map<std::uint32_t, std::size_t> listed_;
};

}  // namespace

Result<Dcf> read_dcf(std::string_view text, std::string_view file) {
  const auto eds = read_eds(text, file);
  if (!eds) return fail(eds.error());
  const auto decoded = to_utf8(text);
  return DcfReader(decoded.text(text), *eds, file).read();
}

}  // namespace servoctl::od
