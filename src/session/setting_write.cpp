#include "session/setting_write.hpp"

#include "drive/quantity.hpp"

namespace servoctl::session {

Result<SdoRequest> setting_write(const drive::Profile& profile, std::uint8_t node,
                                 const drive::Setting& setting) {
  const auto target = drive::resolve(&profile, setting.name);
  if (!target) return fail(target.error());
  const auto data = od::encode(drive::meaning(*target, node).type, od::Value(setting.value));
  if (!data) return fail(data.error());
  return SdoRequest{node, target->address, *data};
}

}  // namespace servoctl::session
