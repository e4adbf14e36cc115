#include "od/learned_mark.hpp"

namespace servoctl::od {

bool is_learned(std::string_view eds) {
  constexpr std::string_view kBegin = "=servoctl-learned:";
  return eds.find(kBegin) != std::string_view::npos;
}

}  // namespace servoctl::od
