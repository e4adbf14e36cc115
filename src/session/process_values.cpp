#include "session/process_values.hpp"

#include "session/can_network.hpp"
#include "session/pdo_setup.hpp"

namespace servoctl::session {

std::unique_ptr<ProcessValues> process_values(Session& session, const drive::Profile* profile,
                                              std::uint8_t node, std::span<const ObjectAddress> objects) {
  if (auto* can = session.can())
    can->learn_pdos(node, read_pdos(session, profile, node).value_or(std::vector<canopen::Pdo>()));
  return session.network().process_values(node, objects);
}

}  // namespace servoctl::session
