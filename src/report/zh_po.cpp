#include "report/zh_po.hpp"

#include "base/embedded.hpp"

SERVOCTL_EMBED(servoctl_zh_po, "report/zh.po")

namespace servoctl::report {

std::string_view zh_po() { return {servoctl_zh_po_begin, servoctl_zh_po_end}; }

}  // namespace servoctl::report
