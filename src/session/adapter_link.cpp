#include "session/adapter_link.hpp"

#include "can/slcan_link.hpp"
#include "can/slcan_opening.hpp"
#include "session/can_network.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {
namespace {

/// So long may an adapter take to be there again.
constexpr Duration kAdapterBack = can::SlcanOpening::kLongest;

/// The bus of the session, for who may not own it.
class LentBus final : public can::Bus {
 public:
  explicit LentBus(can::Bus& bus) : bus_(&bus) {}
  TimePoint now() const override { return bus_->now(); }
  Result<void> send(const can::Frame& frame) override { return bus_->send(frame); }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus_->receive(deadline); }
  TimePoint arrived() const override { return bus_->arrived(); }

 private:
  can::Bus* bus_;
};

}  // namespace

AdapterLink::AdapterLink(Session& session, can::SlcanPlace place)
    : session_(&session), place_(std::move(place)), name_("slcan:" + place_.device) {}

Result<can::LinkState> AdapterLink::state() {
  can::LinkState out;
  out.kind = "can";
  out.up = true;
  out.bitrate = place_.bitrate;
  return out;
}

Result<void> AdapterLink::change(const can::LinkChange& change) {
  if (!change.bitrate) return {};
  if (const auto left = session_->can()->bus().leave_for(*change.bitrate); !left) return left;
  place_.bitrate = *change.bitrate;
  return {};
}

Result<std::unique_ptr<can::Bus>> AdapterLink::listen() {
  auto& bus = session_->can()->bus();
  if (const auto left = bus.leave_for(place_.bitrate); !left) return fail(left.error());
  can::SlcanLink silent(place_);
  const auto opened = silent.change({.up = true, .listen_only = true});
  if (opened) return silent.listen();
  if (opened.error().code != Errc::usage) return fail(opened.error());
  if (const auto back = bus.recover(bus.now() + kAdapterBack); !back) return fail(back.error());
  return std::make_unique<LentBus>(bus);
}

NamedBitrate::~NamedBitrate() {
  const auto bitrate = bitrate_of(session_->url());
  if (!session_->url().starts_with("slcan:") || !bitrate) return;
  if (!session_->can()->bus().leave_for(*bitrate)) return;
  // What fails here is told by the next line that needs the bus.
  (void)session_->network().recover(session_->now() + kAdapterBack);
}

}  // namespace servoctl::session
