#include "session/process_values.hpp"

#include "session/can_network.hpp"
#include "session/pdo_setup.hpp"

namespace servoctl::session {

std::unique_ptr<ProcessValues> process_values(Session& session, const drive::Profile* profile,
                                              std::uint8_t node, std::span<const ObjectAddress> objects) {
  const std::uint8_t nodes[] = {node};
  learn_pdos(session, profile, nodes);
  return session.network().process_values(node, objects);
}

void learn_pdos(Session& session, const drive::Profile* profile, std::span<const std::uint8_t> nodes) {
  auto* can = session.can();
  if (can == nullptr) return;
  const auto answers = read_pdos(session, profile, nodes);
  for (std::size_t i = 0; i < answers.size(); ++i)
    can->learn_pdos(nodes[i], answers[i].value_or(std::vector<canopen::Pdo>()));
}

}  // namespace servoctl::session
