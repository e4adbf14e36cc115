#pragma once

#include <string_view>
#include <vector>

#include "base/utf8.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {

/// What the bytes of an encoding mean whose first 128 characters are ASCII: GBK, CP932, CP950, CP1252, CP850,
/// CP1251. The tables are in the program (code_pages.txt): iconv() reads them from files that small systems
/// do not have, and a statically linked program cannot.
class CodePage {
 public:
  /// Made when it is first asked for. Others than those above have ASCII alone.
  static const CodePage& of(TextEncoding encoding);

  /// The first character of bytes that are not empty; no value where the first byte means nothing.
  CodePoint first(std::string_view bytes) const;

 private:
  explicit CodePage(TextEncoding encoding);

  std::vector<char16_t> single_;   ///< By the byte; 0: means nothing.
  std::vector<char16_t> doubles_;  ///< By both bytes, beginning with 8000h; 0: means nothing.
};

}  // namespace servoctl::od
