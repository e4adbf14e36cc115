#pragma once

/// Makes a file of the sources a part of the program, as read-only data that nothing relocates or reads at
/// its start: `symbol`_begin and `symbol`_end, with a NUL behind. The assembler finds the file below src,
/// which it is given (-I). For use once in a file, outside of any namespace.
#define SERVOCTL_EMBED(symbol, file)                                                            \
  __asm__(".pushsection .rodata." #symbol ",\"a\"\n.global " #symbol "_begin\n.global " #symbol \
          "_end\n" #symbol "_begin:\n.incbin \"" file "\"\n" #symbol                            \
          "_end:\n.byte 0\n"                                                                    \
          ".popsection\n");                                                                     \
  extern "C" {                                                                                  \
  extern const char symbol##_begin[] __attribute__((visibility("hidden")));                     \
  extern const char symbol##_end[] __attribute__((visibility("hidden")));                       \
  }
