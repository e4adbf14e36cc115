#include "od/data_sheet.hpp"

#include <algorithm>
#include <utility>

#include "base/file.hpp"
#include "base/text.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {

SheetName sheet_name(std::string_view word) {
  constexpr std::string_view kMark = ".xml#";
  const auto at = lower(word).rfind(kMark);
  if (at == std::string::npos) return {std::string(word), {}};
  const auto end = at + kMark.size() - 1;
  return {std::string(word.substr(0, end)), std::string(trim(word.substr(end + 1)))};
}

bool is_xml(std::string_view bytes) {
  constexpr std::size_t kSample = 1024;
  const auto head = bytes.substr(0, kSample);
  const auto decoded = to_utf8(head);
  return trim(decoded.text(head)).starts_with('<');
}

Result<EdsFile> read_data_sheet(std::string_view bytes, std::string_view word) {
  if (!is_xml(bytes)) return read_eds(bytes, word);
  const auto name = sheet_name(word);
  auto esi = read_esi(bytes, name.path, name.device);
  if (!esi) return fail(esi.error());
  return std::move(esi->sheet);
}

Result<std::string> read_sheet_file(std::string_view word) {
  return read_file(sheet_name(word).path, std::max(kMostEdsBytes, kMostEsiBytes));
}

}  // namespace servoctl::od
