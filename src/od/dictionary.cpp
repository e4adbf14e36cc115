#include "od/dictionary.hpp"

#include <algorithm>
#include <numeric>

namespace servoctl::od {
namespace {

bool before(const Object& object, std::uint16_t index) { return object.index < index; }

bool is_alnum(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

}  // namespace

std::string_view name(Access access) {
  switch (access) {
    case Access::ro: return "ro";
    case Access::rw: return "rw";
    case Access::wo: return "wo";
    case Access::constant: return "const";
  }
  return "rw";
}

std::string_view name(PdoMapping mapping) {
  switch (mapping) {
    case PdoMapping::no: return "no";
    case PdoMapping::rpdo: return "rpdo";
    case PdoMapping::tpdo: return "tpdo";
    case PdoMapping::both: return "both";
  }
  return "no";
}

std::string_view name(Effect effect) {
  switch (effect) {
    case Effect::unstated: return "";
    case Effect::immediate: return "immediate";
    case Effect::restart: return "restart";
    case Effect::standstill: return "standstill";
  }
  return "";
}

std::optional<Effect> parse_effect(std::string_view text) {
  for (const auto effect : {Effect::unstated, Effect::immediate, Effect::restart, Effect::standstill})
    if (name(effect) == text) return effect;
  return std::nullopt;
}

Value NodeValue::for_node(std::uint8_t node) const {
  if (!plus_node_id) return value;
  if (const auto* number = std::get_if<std::uint64_t>(&value)) return *number + node;
  if (const auto* number = std::get_if<std::int64_t>(&value)) return *number + node;
  return value;
}

void Dictionary::add(Object object) {
  const auto place = std::lower_bound(objects_.begin(), objects_.end(), object.index, before);
  if (place != objects_.end() && place->index == object.index)
    *place = std::move(object);
  else
    objects_.insert(place, std::move(object));
}

const Object* Dictionary::object(std::uint16_t index) const {
  const auto place = std::lower_bound(objects_.begin(), objects_.end(), index, before);
  return place != objects_.end() && place->index == index ? &*place : nullptr;
}

Object* Dictionary::object(std::uint16_t index) {
  return const_cast<Object*>(
      static_cast<const Dictionary&>(*this).object(index));  // NOLINT: the object is ours.
}

const Entry* Dictionary::find(ObjectAddress address) const {
  const auto* found = object(address.index);
  if (found == nullptr) return nullptr;
  const auto place = std::find_if(found->entries.begin(), found->entries.end(),
                                  [&](const Entry& entry) { return entry.address.sub == address.sub; });
  return place == found->entries.end() ? nullptr : &*place;
}

Entry* Dictionary::find(ObjectAddress address) {
  return const_cast<Entry*>(
      static_cast<const Dictionary&>(*this).find(address));  // NOLINT: the object is ours.
}

std::size_t Dictionary::entry_count() const {
  return std::accumulate(objects_.begin(), objects_.end(), std::size_t{0},
                         [](std::size_t sum, const Object& object) { return sum + object.entries.size(); });
}

void inherit(Dictionary& dictionary, const Dictionary& parent) {
  for (const auto& object : parent.objects()) {
    if (auto* own = dictionary.object(object.index); own != nullptr && own->name_zh.empty())
      own->name_zh = object.name_zh;
    for (const auto& from : object.entries) {
      auto* entry = dictionary.find(from.address);
      if (entry == nullptr || entry->type != from.type) continue;
      if (entry->name_zh.empty()) entry->name_zh = from.name_zh;
      if (entry->unit.empty()) {
        entry->unit = from.unit;
        entry->scale = from.scale;
        entry->encoding = from.encoding;
        if (from.doubts.about("unit") && !entry->doubts.about("unit"))
          entry->doubts.assumed.push_back({"unit", {}});
      }
      if (entry->labels.empty()) entry->labels = from.labels;
      if (entry->note.empty()) {
        entry->note = from.note;
        entry->note_zh = from.note_zh;
      }
      entry->command = from.command;
      entry->is_volatile = from.is_volatile;
      if (entry->effect == Effect::unstated && writable(entry->access)) entry->effect = from.effect;
    }
  }
}

std::string identifier(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (is_alnum(c))
      out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!out.empty() && out.back() != '_')
      out += '_';
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

}  // namespace servoctl::od
