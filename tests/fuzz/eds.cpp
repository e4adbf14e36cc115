#include "od/eds.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  const auto file = od::read_eds(input, "fuzz.eds");
  if (!file) {
    fuzz::require(file.error().code == Errc::file, "a file that cannot be read is Errc::file");
    return 0;
  }
  std::size_t lines = 1;
  for (const char c : input) lines += c == '\n' || c == '\r';
  for (const auto& finding : file->diagnostics) {
    fuzz::require(finding.line >= 1 && finding.line <= lines, "a finding stands in a line of the file");
    fuzz::require(!finding.rule.empty() && !finding.message.empty(), "a finding has a rule and a message");
    (void)od::to_string(finding, "fuzz.eds");
  }
  for (const auto& object : file->dictionary.objects())
    for (const auto& entry : object.entries) {
      fuzz::require(file->dictionary.find(entry.address) != nullptr, "every entry is found by its address");
      if (entry.default_value) (void)od::encode(entry.type, entry.default_value->for_node(127));
    }
  return 0;
}
