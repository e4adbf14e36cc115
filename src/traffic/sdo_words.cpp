#include "traffic/sdo_words.hpp"

#include <fmt/format.h>

namespace servoctl::traffic {

using canopen::SdoStep;

std::string_view step_name(SdoStep::Kind kind) {
  switch (kind) {
    case SdoStep::Kind::read: return "read";
    case SdoStep::Kind::write: return "write";
    case SdoStep::Kind::answer: return "answer";
    case SdoStep::Kind::acknowledge: return "acknowledge";
    case SdoStep::Kind::next: return "next";
    case SdoStep::Kind::segment: return "segment";
    case SdoStep::Kind::end: return "end";
    case SdoStep::Kind::abort: return "abort";
    case SdoStep::Kind::unknown: break;
  }
  return "unknown";
}

std::string step_text(const SdoStep& step, const std::string& object, std::string_view abort) {
  switch (step.kind) {
    case SdoStep::Kind::read: return "read " + object;
    case SdoStep::Kind::write: return "write " + object;
    case SdoStep::Kind::answer: return "answer " + object;
    case SdoStep::Kind::acknowledge: return "taken " + object;
    case SdoStep::Kind::segment:
    case SdoStep::Kind::end:
      if (step.data) return (step.from_client ? "write " : "answer ") + object;
      if (step.kind == SdoStep::Kind::end) return "end " + object;
      return fmt::format("segment {}, {} bytes so far", object, step.received);
    case SdoStep::Kind::next: return "go on " + object;
    case SdoStep::Kind::abort:
      return fmt::format("abort {} by the {}: 0x{:08X} {}", object, step.from_client ? "master" : "node",
                         step.abort_code, abort);
    case SdoStep::Kind::unknown: break;
  }
  return "no SDO of CiA 301";
}

}  // namespace servoctl::traffic
