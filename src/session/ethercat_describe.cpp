#include <fmt/format.h>

#include "session/ethercat_network.hpp"

namespace servoctl::session {

Result<ethercat::CoeInfo::Description> EtherCatNetwork::describe(std::uint8_t node, const Question& ask) {
  const auto slave = mailbox_of(node);
  if (!slave) return fail(slave.error());
  ask((*slave)->info(), now());
  for (;;) {
    // The slave may go while it is waited for, and its mailbox with it.
    auto* coe = of(node).coe.get();
    if (coe == nullptr)
      return fail(drive_error(Errc::timeout, node, "it went while it described its objects", "try again"));
    if (auto result = coe->info().take_result()) return std::move(*result);
    if (const auto waited = wire_.go_on(coe->info().deadline()); !waited) return fail(waited.error());
  }
}

}  // namespace servoctl::session
