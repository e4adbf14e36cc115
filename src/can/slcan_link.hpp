#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "can/link_change.hpp"
#include "can/slcan_place.hpp"

namespace servoctl::can {

/// An adapter of the LAWICEL protocol that no bus of this process has open, as an interface whose bitrate can
/// be set: `up` opens it, and closed (C) is what it is put back to. `name` is the one of the bus without its
/// bitrate, `slcan:/dev/ttyACM0`. Errors as SlcanBus::open(): Errc::usage where it refuses a bitrate, or to
/// listen only.
class SlcanLink final : public LinkControl {
 public:
  explicit SlcanLink(SlcanPlace place);
  ~SlcanLink() override;

  const std::string& name() const override { return name_; }
  Result<LinkState> state() override;
  Result<void> change(const LinkChange& change) override;
  /// The bus itself: the adapter is closed when it is destroyed. Errc::bug where it is not up.
  Result<std::unique_ptr<Bus>> listen() override;

 private:
  SlcanPlace place_;
  std::string name_;
  std::unique_ptr<Bus> bus_;
  bool is_known_ = false;  ///< The bitrate is one that was set.
  bool listens_only_ = false;
  std::optional<Error> deaf_;  ///< It cannot listen only.
};

}  // namespace servoctl::can
