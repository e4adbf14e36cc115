#include "traffic/sdo_words.hpp"

#include "base/format.hpp"
#include "report/told.hpp"

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

std::string step_text(const SdoStep& step, const std::string& object, std::string_view abort, bool chinese) {
  switch (step.kind) {
    case SdoStep::Kind::read: return report::told(chinese, "read {}", object);
    case SdoStep::Kind::write: return report::told(chinese, "write {}", object);
    case SdoStep::Kind::answer: return report::told(chinese, "answer {}", object);
    case SdoStep::Kind::acknowledge: return report::told(chinese, "taken {}", object);
    case SdoStep::Kind::segment:
    case SdoStep::Kind::end:
      if (step.data) return report::told(chinese, step.from_client ? "write {}" : "answer {}", object);
      if (step.kind == SdoStep::Kind::end) return report::told(chinese, "end {}", object);
      return report::told(chinese, "segment {}, {} bytes so far", object, step.received);
    case SdoStep::Kind::next: return report::told(chinese, "go on {}", object);
    case SdoStep::Kind::abort:
      return report::told(chinese,
                          step.from_client ? "abort {} by the master: {} {}" : "abort {} by the node: {} {}",
                          object, formatted("0x{:08X}", step.abort_code), abort);
    case SdoStep::Kind::unknown: break;
  }
  return std::string(chinese ? report::chinese_word("no SDO of CiA 301") : "no SDO of CiA 301");
}

}  // namespace servoctl::traffic
