#include "od/esi.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

void check(const od::EsiFile& file, std::size_t lines) {
  for (const auto& finding : file.sheet.diagnostics) {
    fuzz::require(finding.line >= 1 && finding.line <= lines, "a finding stands in a line of the file");
    fuzz::require(!finding.rule.empty() && !finding.message.empty(), "a finding has a rule and a message");
    (void)od::to_string(finding, "fuzz.xml");
  }
  for (const auto& object : file.sheet.dictionary.objects())
    for (const auto& entry : object.entries) {
      fuzz::require(file.sheet.dictionary.find(entry.address) != nullptr,
                    "every entry is found by its address");
      fuzz::require(!entry.default_value || od::encode(entry.type, entry.default_value->value).has_value(),
                    "a default fits its type");
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  std::size_t lines = 1;
  for (const char c : input) lines += c == '\n' || c == '\r';
  const auto all = od::read_all_esi(input, "fuzz.xml");
  if (!all) {
    fuzz::require(all.error().code == Errc::file, "a file that cannot be read is Errc::file");
    return 0;
  }
  for (const auto& file : *all) check(file, lines);
  (void)od::read_esi(input, "fuzz.xml", "1");
  return 0;
}
