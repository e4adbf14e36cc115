#include "traffic/image_pdos.hpp"

#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/ethercat_network.hpp"

namespace servoctl::traffic {
namespace {

using canopen::PdoDirection;

constexpr std::uint16_t kAssignOutputs = 0x1C12;
constexpr std::uint16_t kAssignInputs = 0x1C13;
constexpr std::uint16_t kFirstReceive = 0x1600;
constexpr std::uint16_t kFirstTransmit = 0x1A00;

/// The numbers behind sub-index 0 of a list.
Result<std::vector<std::uint32_t>> read_list(session::Session& session, std::uint8_t node,
                                             std::uint16_t index) {
  const auto count = session.upload(node, {index, 0});
  if (!count) return fail(count.error());
  std::vector<session::SdoRequest> requests;
  for (std::uint64_t sub = 1; sub <= load_le(*count); ++sub)
    requests.push_back({.node = node, .object = {index, static_cast<std::uint8_t>(sub)}});
  std::vector<std::uint32_t> out;
  for (const auto& answer : session.transfer(requests)) {
    if (!answer) return fail(answer.error());
    out.push_back(static_cast<std::uint32_t>(load_le(*answer)));
  }
  return out;
}

Error no_process_data(session::Session& session, std::uint8_t node) {
  const auto& network = session.network();
  const auto state = network.records().state(node);
  return drive_error(
      Errc::negative, node,
      message("no PDOs flow: {}", state ? message("it is in {}", network.state_word(*state))
                                        : std::string("servoctl has not brought it to OP")),
      message("PDOs flow in OP, and as long as servoctl keeps the drive there: `{}` at the prompt or in a "
              "batch file, then `pdo watch`",
              network.state_command(node, session::NodeState::operational)));
}

}  // namespace

Result<std::vector<show::PdoView>> ImagePdos::read(show::Desk& desk, std::uint8_t node) {
  auto& session = *desk.session;
  auto* ring = session.ethercat();
  if (ring == nullptr || ring->image_of(node) == nullptr) return fail(no_process_data(session, node));
  std::vector<show::PdoView> out;
  for (const auto direction : {PdoDirection::receive, PdoDirection::transmit}) {
    const bool receives = direction == PdoDirection::receive;
    const auto assigned = read_list(session, node, receives ? kAssignOutputs : kAssignInputs);
    if (!assigned) return fail(assigned.error());
    for (const auto record : *assigned) {
      const auto entries = read_list(session, node, static_cast<std::uint16_t>(record));
      if (!entries) return fail(entries.error());
      canopen::Pdo pdo{direction,
                       static_cast<std::uint16_t>(record - (receives ? kFirstReceive : kFirstTransmit) + 1)};
      for (const auto entry : *entries) pdo.entries.push_back(canopen::parse_pdo_entry(entry));
      out.push_back(show::make_view(desk.profile, desk.chinese, node, std::move(pdo)));
    }
  }
  return out;
}

std::optional<ImagePdos::Cycle> ImagePdos::take(const show::PdoView& view, TimePoint since) const {
  auto* ring = session_->ethercat();
  const auto* image = ring == nullptr ? nullptr : ring->image_of(view.node);
  if (image == nullptr) return std::nullopt;
  // Both ways go in one frame, and every drive gives its statusword.
  const auto last = image->input(view.node, objects::kStatusword);
  if (!last || last->time <= since) return std::nullopt;
  const bool receives = view.pdo.direction == PdoDirection::receive;
  if (receives && session_->watch().state(view.node) != session::NodeState::operational) return std::nullopt;
  std::vector<Bytes> values;
  for (const auto& entry : view.pdo.entries) {
    if (entry.is_gap()) {
      values.emplace_back();
    } else if (receives) {
      values.push_back(image->output(view.node, entry.object).value_or(Bytes()));
    } else {
      auto input = image->input(view.node, entry.object);
      values.push_back(input ? std::move(input->value) : Bytes());
    }
  }
  return Cycle{canopen::pack_pdo(view.pdo.entries, values), last->time};
}

}  // namespace servoctl::traffic
