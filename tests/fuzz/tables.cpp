// The tables of a drive family: panel parameters, faults, annotations.
#include "drive/fault.hpp"
#include "od/parameter.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto csv = fuzz::text(data, size);
  if (const auto parameters = od::parse_parameters(csv, "fuzz.params.csv"))
    for (const auto& parameter : *parameters) {
      fuzz::require(!parameter.id.empty(), "a parameter has an id");
      if (parameter.default_value) (void)od::encode(parameter.type, *parameter.default_value);
    }
  (void)drive::parse_faults(csv, "fuzz.faults.csv");
  od::Dictionary dictionary;
  (void)od::annotate(dictionary, csv, "fuzz.objects.csv");
  return 0;
}
