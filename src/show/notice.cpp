#include "show/notice.hpp"

#include "base/bytes.hpp"
#include "base/duration.hpp"
#include "base/format.hpp"
#include "show/fault_records.hpp"

namespace servoctl::show {
namespace {

struct Words {
  const session::NodeEvent& event;
  const drive::Profile* profile;
  bool chinese;
  const session::Network* network;

  bool is_ring() const { return network != nullptr && network->is_ring(); }
  std::string_view word(session::NodeState state) const {
    return network != nullptr ? network->state_word(state) : session::name(state);
  }

  std::string operator()(const session::NodeEvent::BootUp&) const {
    return is_ring() ? "it has restarted" : "boot-up";
  }
  std::string operator()(const session::NodeEvent::StateChange& change) const {
    return formatted("{} is now {}", network != nullptr ? network->state_title() : "NMT state",
                     word(change.state));
  }
  std::string operator()(const session::NodeEvent::Gone& gone) const {
    using Sign = session::NodeEvent::Gone::Sign;
    const auto silence = std::chrono::duration_cast<std::chrono::milliseconds>(gone.silence).count();
    switch (gone.sign) {
      case Sign::heartbeat: return formatted("heartbeat lost: silent for {} ms", silence);
      case Sign::guarding: return formatted("node guarding lost: no answer for {} ms", silence);
      case Sign::counter: return formatted("no longer on the ring: no answer for {} ms", silence);
      case Sign::toggle: break;
    }
    return formatted("node guarding lost: toggle bit unchanged for {} ms", silence);
  }
  std::string operator()(const session::NodeEvent::Back& back) const {
    return formatted("{} again, {}", is_ring() ? "is on the ring" : "answers node guarding",
                     word(back.state));
  }
  std::string operator()(const session::NodeEvent::Doubled& doubled) const {
    if (is_ring()) return formatted("two slaves answer under its address: {}", doubled.by);
    return formatted(
        "two nodes answer under this node-ID: {}; switch all but one off and give that another node-ID, or `lss set-node` by serial number: "
        "`help lss set-node`",
        doubled.by);
  }
  std::string operator()(const session::NodeEvent::StateError& error) const {
    return formatted("state error 0x{:04X}: {}", error.code, error.text);
  }
  std::string operator()(const canopen::Emergency& e) const {
    const bool bare = e.code == 0 && e.error_register == 0 && e.vendor == decltype(e.vendor){};
    if (bare) return "EMCY 0x0000: error reset or no error";
    if (e.size == 2) return formatted("EMCY 0x{:04X} {}", e.code, fault_words(profile, chinese, e.code));
    return formatted("EMCY 0x{:04X} {}; error register 0x{:02X} ({}); vendor bytes {}", e.code,
                     fault_words(profile, chinese, e.code, e.vendor), e.error_register,
                     canopen::error_register_text(e.error_register), to_hex(e.vendor));
  }
};

}  // namespace

std::string event_text(const session::NodeEvent& event, const drive::Profile* profile, bool chinese,
                       const session::Network* network) {
  auto out = std::visit(Words{event, profile, chinese, network}, event.what);
  if (event.times > 1) out += formatted("; {} times in a row", event.times);
  return out;
}

Message notice_text(const session::NodeEvent& event, const drive::Profile* profile, bool chinese,
                    const session::Network* network) {
  return message("node {}: {}", node_name(event.node), event_text(event, profile, chinese, network));
}

}  // namespace servoctl::show
