#include "drive/enabling_write.hpp"

#include "drive/cia402.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {

bool is_enabling_write(ObjectAddress object, ByteSpan data) {
  // Bit 7 is left out: with it set the drive looks at its edge only, and the word may follow another.
  const auto controlword = static_cast<std::uint16_t>(load_le(data) & 0xFF7FU);
  return object == objects::kControlword &&
         decode_command(controlword, 0) == ControlCommand::enable_operation;
}

const PowerParameter* power_parameter(const Profile* profile, ObjectAddress object, ByteSpan data) {
  if (profile == nullptr || load_le(data) == 0) return nullptr;
  for (const auto& parameter : profile->rules.motion.without_controlword)
    if (place_of(*profile, parameter.name) == object) return &parameter;
  return nullptr;
}

}  // namespace servoctl::drive
