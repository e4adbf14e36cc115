#include "settings/register_writes.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "session/modbus_network.hpp"
#include "settings/comparison.hpp"

namespace servoctl::settings {
namespace {

constexpr std::size_t kBytesOfRegister = 2;

bool takes_its_address(const show::Desk& desk, const Change& change) {
  if (desk.profile == nullptr || desk.profile->rules.modbus.node_id.empty()) return false;
  return drive::place_of(*desk.profile, desk.profile->rules.modbus.node_id) == change.target.address &&
         load_le(change.data) == 0;
}

/// What moves, or may move, the motor over Modbus; nothing on another network.
std::vector<std::string> names_of_motion(const show::Desk& desk) {
  if (desk.profile == nullptr || desk.session->modbus() == nullptr) return {};
  const auto& rules = desk.profile->rules.modbus;
  auto out = rules.at_rest;
  out.insert(out.end(), rules.targets.begin(), rules.targets.end());
  return out;
}

}  // namespace

bool is_told_not_at_rest(const show::Desk& desk, ObjectAddress object) {
  const auto names = names_of_motion(desk);
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return drive::place_of(*desk.profile, name) == object; });
}

Result<void> check_registers(const show::Desk& desk, std::span<const Change> changes) {
  const auto* line = desk.session->modbus();
  if (line == nullptr) return {};
  for (const auto& change : changes) {
    const auto refused = [&](Errc code, Message what, Message hint) {
      return fail(drive_error(code, change.node, change.target.address, std::move(what), std::move(hint)));
    };
    if (line->is_known(change.node) && !line->has_register(change.node, change.target.address))
      return refused(Errc::sdo_abort, "it has no Modbus register",
                     "nothing was written; `param list` shows what has one");
    if (change.data.size() != kBytesOfRegister)
      return refused(Errc::usage,
                     message("{} bytes do not go into a register, which has 2", change.data.size()),
                     "nothing was written; leave --type out, or say u16 or i16");
    if (takes_its_address(desk, change))
      return refused(Errc::usage, "0 is the address of messages to all: it would answer nobody over Modbus",
                     "nothing was written; addresses are 1 to 127");
  }
  return {};
}

std::string_view register_reason(const show::Desk& desk, const Change& change) {
  const bool is_asked = desk.session != nullptr && desk.session->modbus() != nullptr &&
                        desk.profile != nullptr && is_line_address(*desk.profile, change.target.address);
  return is_asked ? "After a restart the drive has another Modbus address, speed or form of frames." : "";
}

bool is_only_echoed(const show::Desk& desk, std::span<const Change> changes) {
  return desk.session->modbus() != nullptr &&
         std::none_of(changes.begin(), changes.end(), [](const Change& change) {
           return change.target.parameter != nullptr && change.target.parameter->command;
         });
}

void tell_not_at_rest(show::Desk& desk, std::span<const Change> changes,
                      std::span<const Result<session::Written>> written) {
  for (const auto& name : names_of_motion(desk)) {
    const auto place = drive::place_of(*desk.profile, name);
    for (std::size_t i = 0; i < changes.size(); ++i)
      if (place == changes[i].target.address && load_le(changes[i].data) != 0 &&
          session::write_end(written[i], changes[i].target.address) != session::WriteEnd::not_written)
        desk.notices.push_back(message(
            "node {}: its motor may be energised and turn, and nothing stops it when servoctl or the cable is "
            "gone: `param set {}=0 -n {}`",
            node_name(changes[i].node), as_it_is(name), node_name(changes[i].node)));
  }
}

}  // namespace servoctl::settings
