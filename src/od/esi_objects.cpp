#include "od/esi_objects.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/pdo_index.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"
#include "od/esi_entry.hpp"
#include "od/esi_types.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::size_t kMostEsiEntries = 100'000;
constexpr std::size_t kMostItems = 1024;  ///< Beyond what sub-indices there are.

struct ObjectPlace {
  std::uint16_t index = 0;
  XmlElement element;
};

/// Which Info of an object's belongs to which of its entries: by name where each has its own, else by order.
class SubInfos {
 public:
  SubInfos(XmlElement object, const std::vector<EsiMember>& members)
      : items_(object.child("Info").children("SubItem", kMostItems)) {
    places_.resize(members.size(), items_.size());
    const bool all_named = match_names(members);
    if (all_named || items_.size() != members.size()) return;
    for (std::size_t i = 0; i < members.size(); ++i) places_[i] = i;
  }

  XmlElement of(std::size_t member) const {
    return places_[member] < items_.size() ? items_[places_[member]] : XmlElement();
  }
  /// The first that belongs to no entry.
  XmlElement left_over() const {
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (std::find(places_.begin(), places_.end(), i) == places_.end()) return items_[i];
    return {};
  }

 private:
  /// Those of one name in their order; elements of an array by their place. Whether all have found theirs.
  bool match_names(const std::vector<EsiMember>& members) {
    bool all = true;
    const auto is_free = [&](std::size_t k) { return places_[k] == items_.size(); };
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const auto name = items_[i].child("Name").text();
      std::size_t k = i < members.size() && members[i].of_array && is_free(i) ? i : 0;
      while (k < members.size() && !(k == i && members[k].of_array) &&
             !(is_free(k) && !members[k].of_array && members[k].element.child("Name").text() == name))
        ++k;
      all = all && k < members.size();
      if (k < members.size()) places_[k] = i;
    }
    return all;
  }

  std::vector<XmlElement> items_;
  std::vector<std::size_t> places_;  ///< Of the item for each member.
};

class ObjectReader {
 public:
  ObjectReader(XmlElement element, Dictionary& dictionary, BitSizes& sizes, EsiFindings& findings)
      : types_(element.child("DataTypes"), findings),
        dictionary_(&dictionary),
        sizes_(&sizes),
        findings_(&findings) {}

  void read(XmlElement objects) {
    std::vector<ObjectPlace> places;
    for (const auto& element : objects.children("Object"))
      if (const auto index = index_of(element)) places.push_back({*index, element});
    std::stable_sort(places.begin(), places.end(),
                     [](const ObjectPlace& a, const ObjectPlace& b) { return a.index < b.index; });
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i > 0 && places[i].index == places[i - 1].index)
        tell_duplicate(places[i], places[i - 1]);
      else
        read_object(places[i]);
    }
  }

 private:
  std::optional<std::uint16_t> index_of(XmlElement element) {
    const auto at = element.child("Index");
    const auto number = esi_integer(at.text());
    if (number && !number->negative && number->magnitude <= 0xFFFF)
      return static_cast<std::uint16_t>(number->magnitude);
    findings_->error(
        at ? at : element, "bad-index",
        at ? formatted("'{}' is not an index", shown(at.text())) : std::string("the object has no Index"),
        "write an index such as #x2000");
    return std::nullopt;
  }

  void tell_duplicate(ObjectPlace& again, const ObjectPlace& first) {
    findings_->error(again.element, "duplicate-object",
                     formatted("0x{:04X} appears again, first in line {}; the first one is used", again.index,
                               first.element.place().line),
                     "remove one of them");
  }

  void read_object(const ObjectPlace& place) {
    // An object has 256 at most.
    if (entries_left_ <= 0xFF) {
      findings_->error(place.element, "too-many-entries",
                       "more entries than any device has; the object is left out",
                       "are the numbers of Elements too high?");
      return;
    }
    Object object;
    object.index = place.index;
    auto name = esi_text(place.element, "Name");
    if (name.english.empty())
      findings_->warn(place.element, "missing-name", formatted("0x{:04X} has no Name", place.index),
                      "add Name");
    object.name = name.english;
    const auto type_name = place.element.child("Type").text();
    if (const auto composite = types_.composite(type_name); composite && !types_.plain(type_name))
      add_members(place.element, composite, type_name, name, object);
    else
      add_single(place.element, type_name, std::move(name), object);
    if (!object.entries.empty()) dictionary_->add(std::move(object));
  }

  void add_single(XmlElement element, std::string_view type_name, EsiText name, Object& object) {
    auto type = types_.demand(type_name, element.child("Type") ? element.child("Type") : element, *findings_);
    if (!type) return;
    object.code = type->type == DataType::domain ? ObjectCode::domain : ObjectCode::var;
    Entry entry;
    entry.address = {object.index, 0};
    entry.name = std::move(name.english);
    entry.name_zh = std::move(name.chinese);
    check_size(element, *type, entry);
    finish(element, element, element.child("Info"), std::move(*type), std::move(entry), object);
  }

  void add_members(XmlElement element, XmlElement composite, std::string_view type_name, const EsiText& name,
                   Object& object) {
    const auto& members = types_.members(type_name, *findings_);
    const SubInfos infos(element, members);
    const bool has_array =
        std::any_of(members.begin(), members.end(), [](const EsiMember& m) { return m.of_array; });
    object.code = has_array ? ObjectCode::array : ObjectCode::record;
    for (std::size_t i = 0; i < members.size(); ++i)
      add_member(element, members[i], infos.of(i), name, object);
    if (const auto extra = infos.left_over())
      findings_->warn(extra, "sub-item-without-type",
                      formatted("0x{:04X}: '{}' is none of the entries of {}; it is ignored", object.index,
                                shown(extra.child("Name").text()), shown(composite.child("Name").text())),
                      "name it as the SubItem of the type, or add one there");
    check_sub_0(element, object);
  }

  void add_member(XmlElement element, const EsiMember& member, XmlElement item, const EsiText& object_name,
                  Object& object) {
    Entry entry;
    entry.address = {object.index, member.sub};
    const bool twice = std::any_of(object.entries.begin(), object.entries.end(),
                                   [&](const Entry& e) { return e.address.sub == member.sub; });
    if (twice) {
      findings_->error(member.element, "duplicate-sub-index",
                       formatted("{} appears again; the first one is used", to_string(entry.address)),
                       "correct SubIdx");
      return;
    }
    auto type = types_.plain(member.type);
    if (!type) return;
    name_member(member, item, object_name, entry);
    if (!member.of_array) check_size(member.element, *type, entry);
    // What the type says of its entry holds where the object says nothing.
    esi_values_of_type(member.element, *type, entry);
    finish(member.element, element, item.child("Info"), std::move(*type), std::move(entry), object);
  }

  /// The object's own words for an entry go before those of its type; elements of an array are numbered.
  static void name_member(const EsiMember& member, XmlElement item, const EsiText& object_name,
                          Entry& entry) {
    auto display = esi_text(item, "DisplayName");
    auto name = esi_text(item, "Name");
    const bool own = !display.english.empty() || (!name.english.empty() && member.of_array);
    entry.name = !display.english.empty() ? display.english : own ? name.english : member.name;
    entry.name_zh = !display.chinese.empty() ? display.chinese : own ? name.chinese : member.name_zh;
    if (!member.of_array || own) return;
    entry.name = formatted("{} {}", object_name.english, member.sub);
    if (!object_name.chinese.empty()) entry.name_zh = formatted("{} {}", object_name.chinese, member.sub);
  }

  void esi_values_of_type(XmlElement item, const EsiType& type, Entry& entry) {
    entry.type = type.type;
    esi_values(item, entry, *findings_);
  }

  void check_size(XmlElement element, const EsiType& type, const Entry& entry) {
    const auto at = element.child("BitSize");
    if (at.text().empty() || type.bits == 0 || type.type == DataType::string || type.type == DataType::bytes)
      return;
    const auto bits = esi_number(at, 0xFFFF'FFFF, *findings_, type.bits);
    const bool padded = type.type == DataType::boolean && bits == 8;
    if (bits != type.bits && !padded)
      findings_->warn(at, "bit-size",
                      formatted("{}: {} bits, but its type has {}; taken as {}", to_string(entry.address),
                                bits, type.bits, name(type.type)),
                      formatted("write {}, or another type", type.bits));
  }

  void finish(XmlElement described_by, XmlElement element, XmlElement info, EsiType type, Entry entry,
              Object& object) {
    entry.type = type.type;
    entry.line = described_by.place().line;
    read_esi_flags(described_by, element, entry, *findings_);
    read_esi_remarks(described_by, info, entry);
    esi_values(info, entry, *findings_);
    check_esi_limits(info ? info : described_by, entry, *findings_);
    if (!entry.low) entry.low = type.low;
    if (!entry.high) entry.high = type.high;
    if (type.labels.size() <= labels_left_) {
      labels_left_ -= type.labels.size();
      entry.labels = std::move(type.labels);
    }
    const auto whole = size_of(entry.type);
    if (whole && type.bits != 8 * *whole) sizes_->emplace(entry.address, type.bits);
    --entries_left_;
    const auto place = std::find_if(object.entries.begin(), object.entries.end(),
                                    [&](const Entry& e) { return e.address.sub > entry.address.sub; });
    object.entries.insert(place, std::move(entry));
  }

  /// Sub 0 is the highest sub-index; a list that is filled at run time begins with less than it has room for.
  void check_sub_0(XmlElement element, const Object& object) {
    if (object.entries.empty() || object.entries.front().address.sub != 0) return;
    const auto& count = object.entries.front();
    if (!count.default_value || !is_integer(count.type)) return;
    const auto said = to_double(count.default_value->value);
    const auto highest = object.entries.back().address.sub;
    if (said > highest && !is_pdo_mapping(object.index))
      findings_->warn(element, "sub-0-value",
                      formatted("0x{:04X}: sub 0 says the highest sub-index is {}; it is {}", object.index,
                                to_string(count.default_value->value), highest),
                      formatted("write {}, or add the SubItems that are missing", highest));
  }

  EsiTypes types_;
  Dictionary* dictionary_;
  BitSizes* sizes_;
  EsiFindings* findings_;
  std::size_t entries_left_ = kMostEsiEntries;
  std::size_t labels_left_ = 10 * kMostEsiEntries;
};

}  // namespace

void read_esi_objects(XmlElement element, Dictionary& dictionary, BitSizes& sizes, EsiFindings& findings) {
  ObjectReader(element, dictionary, sizes, findings).read(element.child("Objects"));
}

}  // namespace servoctl::od
