#include "drive/rules.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rules = drive::parse_rules(fuzz::text(data, size), "fuzz.toml");
  if (rules) {
    fuzz::require(!rules->family.empty(), "rules name their family");
    for (const auto& rule : rules->numbering)
      fuzz::require(rule.block > 0, "a block of parameters is not empty");
  } else {
    fuzz::require(rules.error().code == Errc::file, "rules that cannot be read are Errc::file");
  }
  return 0;
}
