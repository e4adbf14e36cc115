#include "sim/esc_process_data.hpp"

#include <algorithm>

#include "drive/naming.hpp"
#include "sim/esc_bits.hpp"
#include "sim/esc_states.hpp"

namespace servoctl::sim {

std::uint16_t EscProcessData::load() {
  const auto& rules = model_->profile().rules.pdo;
  if (!load(rules.assign_rpdo, outputs_)) return al_code::kOutputMapping;
  return load(rules.assign_tpdo, inputs_) ? al_code::kNone : al_code::kInputMapping;
}

bool EscProcessData::load(const std::string& assignment, Fields& out) const {
  out.clear();
  const auto& values = model_->values();
  const auto object = drive::resolve(&model_->profile(), assignment);
  if (!object) return true;
  const auto index = object->address.index;
  const auto count = std::min<std::uint64_t>(values.number({index, 0}), values.last_sub(index));
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const auto pdo = static_cast<std::uint16_t>(values.number({index, sub}));
    if (pdo == 0) continue;
    if (!values.has({pdo, 0})) return false;
    add_mapping(pdo, out);
  }
  return true;
}

void EscProcessData::add_mapping(std::uint16_t index, Fields& out) const {
  const auto& values = model_->values();
  const auto count = values.number({index, 0});
  for (unsigned sub = 1; sub <= count; ++sub) {
    const auto entry = values.number({index, static_cast<std::uint8_t>(sub)});
    const ObjectAddress object{static_cast<std::uint16_t>(entry >> 16U),
                               static_cast<std::uint8_t>(entry >> 8U & 0xFFU)};
    out.push_back({object, entry & 0xFFU, values.has(object)});
  }
}

std::size_t EscProcessData::size_of(const Fields& fields) {
  std::size_t bits = 0;
  for (const auto& field : fields) bits += field.bits;
  return (bits + 7) / 8;
}

void EscProcessData::apply(ByteSpan outputs) {
  std::size_t at = 0;
  for (const auto& field : outputs_) {
    if (at + field.bits > outputs.size() * 8) return;
    Bytes value((field.bits + 7) / 8, 0);
    copy_bits(value, 0, outputs, at, field.bits);
    at += field.bits;
    if (field.known) (void)model_->write(field.object, value);
  }
}

Bytes EscProcessData::sample() {
  Bytes out(input_size(), 0);
  std::size_t at = 0;
  for (const auto& field : inputs_) {
    Bytes value;
    if (field.known) (void)model_->read(field.object, value);
    value.resize((field.bits + 7) / 8);
    copy_bits(out, at, value, 0, field.bits);
    at += field.bits;
  }
  return out;
}

bool EscProcessData::carries_output(ObjectAddress object) const {
  return std::any_of(outputs_.begin(), outputs_.end(),
                     [&](const Field& field) { return field.known && field.object == object; });
}

}  // namespace servoctl::sim
