#include "report/zh_po.hpp"

// Read-only data of the program: nothing is relocated or read at its start. The assembler finds the file
// beside the sources, whose folder it is given (-I), so that no path of a machine stands here.
__asm__(
    ".pushsection .rodata.servoctl_zh_po,\"a\",@progbits\n"
    ".global servoctl_zh_po_begin\n"
    ".global servoctl_zh_po_end\n"
    "servoctl_zh_po_begin:\n"
    ".incbin \"report/zh.po\"\n"
    "servoctl_zh_po_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" {
extern const char servoctl_zh_po_begin[] __attribute__((visibility("hidden")));
extern const char servoctl_zh_po_end[] __attribute__((visibility("hidden")));
}

namespace servoctl::report {

std::string_view zh_po() { return {servoctl_zh_po_begin, servoctl_zh_po_end}; }

}  // namespace servoctl::report
