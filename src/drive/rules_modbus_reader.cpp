#include <algorithm>

#include "drive/rules_reader.hpp"

namespace servoctl::drive {
namespace {

bool read_block(const toml::node& node, ModbusRules::Block& out) {
  constexpr unsigned kEnd = 0x10000;
  return has_only(node, {"index", "count", "at"}) && get(at(node, "index"), out.index) &&
         get(at(node, "count"), out.count) && get(at(node, "at"), out.at) && out.count > 0 &&
         unsigned{out.index} + out.count <= kEnd && unsigned{out.at} + out.count <= kEnd;
}

}  // namespace

Result<void> read_modbus(const TableReader& reader, Rules& rules) {
  auto& out = rules.modbus;
  const auto bits = [](std::uint16_t& place) {
    constexpr std::uint16_t kMost = 32;
    return [&place](const toml::node& n) { return get(n, place) && place <= kMost; };
  };
  return reader.read({{"registers", [&](const auto& n) { return get_list(n, out.registers, read_block); }},
                      {"node_id", into(out.node_id)},
                      {"baud", into(out.baud)},
                      {"framing", into(out.framing)},
                      {"silence_ms", into(out.silence_ms)},
                      {"at_rest", into(out.at_rest)},
                      {"targets", into(out.targets)},
                      {"shows", into(out.shows)},
                      {"inputs", bits(out.inputs)},
                      {"outputs", bits(out.outputs)},
                      {"motion", into(out.motion)},
                      {"motion_zh", into(out.motion_zh)}});
}

std::optional<std::uint16_t> ModbusRules::register_of(ObjectAddress object) const {
  if (object.sub != 0) return std::nullopt;
  for (const auto& block : registers)
    if (object.index >= block.index && object.index - block.index < block.count)
      return static_cast<std::uint16_t>(block.at + (object.index - block.index));
  return std::nullopt;
}

std::optional<ObjectAddress> ModbusRules::object_at(std::uint16_t address) const {
  for (const auto& block : registers)
    if (address >= block.at && address - block.at < block.count)
      return ObjectAddress{static_cast<std::uint16_t>(block.index + (address - block.at)), 0};
  return std::nullopt;
}

}  // namespace servoctl::drive
