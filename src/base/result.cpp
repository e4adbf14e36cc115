#include "base/result.hpp"

namespace servoctl {

int exit_code(Errc code) {
  switch (code) {
    case Errc::negative: return 1;
    case Errc::usage: return 2;
    case Errc::bus: return 3;
    case Errc::timeout: return 4;
    case Errc::sdo_abort: return 5;
    case Errc::protocol: return 6;
    case Errc::file: return 7;
    case Errc::refused: return 8;
    case Errc::bug: return 70;
    case Errc::interrupted: return 130;
  }
  return 70;
}

std::string_view name(Errc code) {
  switch (code) {
    case Errc::negative: return "negative";
    case Errc::usage: return "usage";
    case Errc::bus: return "bus";
    case Errc::timeout: return "no-answer";
    case Errc::sdo_abort: return "sdo-abort";
    case Errc::protocol: return "protocol";
    case Errc::file: return "file";
    case Errc::refused: return "refused";
    case Errc::bug: return "bug";
    case Errc::interrupted: return "interrupted";
  }
  return "bug";
}

}  // namespace servoctl
