#include "tests/source_dir.hpp"

namespace servoctl {

std::string source_dir() { return SERVOCTL_SOURCE_DIR; }

}  // namespace servoctl
