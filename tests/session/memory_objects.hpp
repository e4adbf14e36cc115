#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "canopen/sdo_server.hpp"
#include "drive/profile.hpp"

namespace servoctl::session {

/// Objects in a map; what is not there does not exist, and a write keeps the length.
class MemoryObjects final : public canopen::ObjectStore {
 public:
  std::uint32_t read(ObjectAddress object, Bytes& out) override {
    const auto found = values.find(object);
    if (found == values.end()) return 0x0602'0000;
    out = found->second;
    return 0;
  }
  std::uint32_t write(ObjectAddress object, ByteSpan data) override {
    const auto found = values.find(object);
    if (found == values.end()) return 0x0602'0000;
    if (read_only.count(object) != 0) return 0x0601'0002;
    if (found->second.size() != data.size()) return 0x0607'0010;
    found->second.assign(data.begin(), data.end());
    writes.emplace_back(object, found->second);
    return 0;
  }

  std::map<ObjectAddress, Bytes> values;
  std::set<ObjectAddress> read_only;
  std::vector<std::pair<ObjectAddress, Bytes>> writes;
};

/// The objects a drive of the family has before anything was set.
inline MemoryObjects objects_of(const drive::Profile& profile, std::uint8_t node) {
  MemoryObjects out;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries) {
      auto& bytes = out.values[entry.address];
      bytes.assign(od::size_of(entry.type).value_or(8), 0);
      if (!entry.default_value) continue;
      if (auto encoded = od::encode(entry.type, entry.default_value->for_node(node)))
        bytes = std::move(*encoded);
    }
  return out;
}

}  // namespace servoctl::session
