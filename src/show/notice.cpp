#include "show/notice.hpp"

#include <fmt/format.h>

#include "base/bytes.hpp"
#include "base/duration.hpp"
#include "show/fault_records.hpp"

namespace servoctl::show {
namespace {

struct Words {
  const canopen::NodeEvent& event;
  const drive::Profile* profile;
  bool chinese;

  std::string operator()(const canopen::NodeEvent::BootUp&) const { return "boot-up"; }
  std::string operator()(const canopen::NodeEvent::StateChange& change) const {
    return fmt::format("NMT state is now {}", canopen::name(change.state));
  }
  std::string operator()(const canopen::NodeEvent::HeartbeatLost& lost) const {
    const auto silence = std::chrono::duration_cast<std::chrono::milliseconds>(lost.silence);
    return fmt::format("heartbeat lost: silent for {} ms", silence.count());
  }
  std::string operator()(const canopen::NodeEvent::GuardingLost& lost) const {
    const auto silence = std::chrono::duration_cast<std::chrono::milliseconds>(lost.silence).count();
    return lost.wrong_toggle
               ? fmt::format("node guarding lost: its answers do not change their toggle bit, for {} ms",
                             silence)
               : fmt::format("node guarding lost: no answer for {} ms", silence);
  }
  std::string operator()(const canopen::NodeEvent::GuardingBack& back) const {
    return fmt::format("answers node guarding again, {}", canopen::name(back.state));
  }
  std::string operator()(const canopen::NodeEvent::Doubled& doubled) const {
    return (chinese ? "两个节点使用同一个节点号: " : "two nodes answer under this number: ") + doubled.by;
  }
  std::string operator()(const canopen::Emergency& e) const {
    if (e.is_reset()) return "EMCY 0x0000: error reset or no error";
    if (e.size == 2) return fmt::format("EMCY 0x{:04X} {}", e.code, fault_words(profile, chinese, e.code));
    return fmt::format("EMCY 0x{:04X} {}; error register 0x{:02X} ({}); vendor bytes {}", e.code,
                       fault_words(profile, chinese, e.code, e.vendor), e.error_register,
                       canopen::error_register_text(e.error_register), to_hex(e.vendor));
  }
};

}  // namespace

std::string notice_text(const canopen::NodeEvent& event, const drive::Profile* profile, bool chinese) {
  auto out = fmt::format("node {}: {}", event.node, std::visit(Words{event, profile, chinese}, event.what));
  if (event.times > 1) out += fmt::format("; {} times in succession", event.times);
  return out;
}

}  // namespace servoctl::show
