#include "can/slcan_link.hpp"

#include <utility>

#include "base/format.hpp"
#include "can/slcan.hpp"

namespace servoctl::can {

SlcanLink::SlcanLink(SlcanPlace place) : place_(std::move(place)), name_("slcan:" + place_.device) {}

SlcanLink::~SlcanLink() = default;

Result<LinkState> SlcanLink::state() {
  LinkState out;
  out.kind = "can";
  out.up = bus_ != nullptr;
  if (is_known_) out.bitrate = place_.bitrate;
  out.listen_only = listens_only_;
  return out;
}

Result<void> SlcanLink::change(const LinkChange& change) {
  if (change.up == false) bus_.reset();
  if (change.listen_only == true && deaf_) return fail(*deaf_);
  if (change.bitrate) {
    if (!slcan_bitrate_digit(*change.bitrate))
      return fail(Errc::usage, message("{} bit/s is no bitrate that such an adapter has", *change.bitrate),
                  message("one of {}", slcan_bitrates_text()));
    place_.bitrate = *change.bitrate;
    is_known_ = true;
  }
  if (change.listen_only) listens_only_ = *change.listen_only;
  if (change.up != true) return {};
  auto bus = std::make_unique<SlcanBus>(
      place_, listens_only_ ? SlcanOpening::Mode::listen_only : SlcanOpening::Mode::normal);
  if (const auto opened = bus->open(kNever, true); !opened) {
    if (bus->refuses_to_listen()) deaf_ = opened.error();
    return opened;
  }
  bus_ = std::move(bus);
  return {};
}

Result<std::unique_ptr<Bus>> SlcanLink::listen() {
  if (!bus_) return fail(Errc::bug, name_ + " is not up");
  return std::move(bus_);
}

}  // namespace servoctl::can
