// What an exchange carries: the PDOs of a slave, and what its outputs begin with.
#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/ethercat_exchange.hpp"

namespace servoctl::session {
namespace {

constexpr std::uint16_t kAssignOutputs = 0x1C12;
constexpr std::uint16_t kAssignInputs = 0x1C13;

bool carries(const std::vector<canopen::PdoEntry>& entries, ObjectAddress object) {
  return std::any_of(entries.begin(), entries.end(), [&](const auto& e) { return e.object == object; });
}

}  // namespace

Result<EtherCatNode::Assignment> EtherCatExchange::assigned(std::uint16_t index) {
  const auto count = upload({index, 0});
  if (!count) return fail(count.error());
  EtherCatNode::Assignment out{index, static_cast<std::uint8_t>(load_le(*count)), {}};
  for (std::uint8_t sub = 1; sub <= std::max<std::uint8_t>(out.count, 1); ++sub) {
    const auto pdo = upload({index, sub});
    if (!pdo) return fail(pdo.error());
    out.pdos.push_back(static_cast<std::uint16_t>(load_le(*pdo)));
  }
  return out;
}

/// The list is switched off while it is written (ETG.1000.6, 5.6.7.4.7). What lies behind those in use may
/// not be writable.
Result<void> EtherCatExchange::assign(const EtherCatNode::Assignment& assignment) {
  const auto index = assignment.index;
  if (auto done = download({index, 0}, {0}); !done) return done;
  for (std::size_t i = 0; i < assignment.pdos.size(); ++i) {
    auto done = download({index, static_cast<std::uint8_t>(i + 1)}, store_le(assignment.pdos[i], 2));
    if (!done && (i < assignment.count || done.error().code != Errc::sdo_abort)) return done;
  }
  return download({index, 0}, {assignment.count});
}

Result<std::vector<canopen::PdoEntry>> EtherCatExchange::entries(const std::vector<std::uint16_t>& pdos) {
  std::vector<canopen::PdoEntry> out;
  for (const auto pdo : pdos) {
    const auto count = upload({pdo, 0});
    if (!count) return fail(count.error());
    for (std::uint64_t sub = 1; sub <= load_le(*count); ++sub) {
      const auto entry = upload({pdo, static_cast<std::uint8_t>(sub)});
      if (!entry) return fail(entry.error());
      out.push_back(canopen::parse_pdo_entry(static_cast<std::uint32_t>(load_le(*entry))));
    }
  }
  return out;
}

/// What one direction carries; where that lacks what a motion needs, with what the family's rules name.
Result<std::vector<canopen::PdoEntry>> EtherCatExchange::side(std::uint16_t index, std::uint16_t wanted,
                                                              ObjectAddress needed) {
  const auto before = assigned(index);
  if (!before) return fail(before.error());
  auto out = entries(before->in_use());
  if (!out || carries(*out, needed)) return out;
  if (wanted == 0)
    return fail(
        drive_error(Errc::refused, node_->number, {index, 0},
                    message("the assigned PDOs do not carry {}, and process data without it are no use",
                            to_string(needed)),
                    "assign PDOs that do: `pdo show` shows them; or name the drive's family with -d"));
  node_->assigned.push_back(*before);
  if (const auto done = assign({index, 1, {wanted}}); !done) return fail(done.error());
  out = entries({wanted});
  if (!out || carries(*out, needed)) return out;
  return fail(drive_error(Errc::protocol, node_->number, {wanted, 0},
                          message("it does not carry {}", to_string(needed)),
                          "the family's data names it for motions: is the drive of this family?"));
}

Result<ethercat::ProcessMapping> EtherCatExchange::mapping() {
  ethercat::ProcessMapping out;
  auto outputs = side(kAssignOutputs, node_->rules.rpdo, objects::kControlword);
  if (!outputs) return fail(outputs.error());
  auto inputs = side(kAssignInputs, node_->rules.tpdo, objects::kStatusword);
  if (!inputs) return fail(inputs.error());
  out.outputs = std::move(*outputs);
  out.inputs = std::move(*inputs);
  return out;
}

/// A zero that nobody meant must not move, stop or starve a motor.
Result<std::vector<EtherCatExchange::Preset>> EtherCatExchange::presets(
    const std::vector<canopen::PdoEntry>& outputs) {
  std::vector<Preset> out;
  for (const auto& entry : outputs) {
    if (entry.is_gap()) continue;
    const auto object = entry.object;
    const std::size_t size = (entry.bits + 7U) / 8U;
    if (object == objects::kControlword || object == objects::kTargetVelocity ||
        object == objects::kTargetTorque) {
      out.push_back({object, Bytes(size, 0)});
      continue;
    }
    const auto from = object == objects::kTargetPosition ? objects::kPositionActual : object;
    const auto value = upload(from);
    if (!value && value.error().code != Errc::sdo_abort) return fail(value.error());
    if (!value || value->size() != size)
      return fail(drive_error(
          Errc::refused, node_->number, object,
          value ? message("it is an output of {} bytes, and the drive gave {} for it", size, value->size())
                : message("it is an output, and {} cannot be read to preset it", to_string(from)),
          "outputs are preset from the drive: do not map one that cannot be read; `pdo show`"));
    out.push_back({object, *value});
  }
  return out;
}

}  // namespace servoctl::session
