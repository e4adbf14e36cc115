// Recordings of every form: whatever a file holds, what is read are frames of a classical bus, and a place of
// damage lies in the file.
#include "can/recording.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  std::size_t count = 0;
  const auto strays = can::for_each_frame(input, [&](const can::LogFrame& line) {
    ++count;
    fuzz::require(line.frame.size <= 8, "a classical frame has at most 8 bytes");
    fuzz::require(line.frame.id <= 0x1FFF'FFFFU, "an identifier has at most 29 bits");
    fuzz::require(line.time >= Duration::zero(), "no time lies before the beginning");
    fuzz::require(can::parse_log_line(can::to_string(line)).has_value(), "a frame written is read again");
    return count < 10'000;
  });
  if (strays.damage) fuzz::require(strays.damage->offset <= size, "damage lies in the file");
  // As the user names the columns.
  static const auto columns = can::ColumnChoice::parse("time:ms,-,id:hex,len,data:hex");
  (void)can::for_each_frame(
      input, [](const can::LogFrame& line) { return fuzz::require(line.frame.size <= 8, "as above"), true; },
      {.columns = &*columns});
  std::size_t first = 0;
  (void)can::for_each_frame(input, [&](const can::LogFrame&) { return ++first == 0; });
  fuzz::require(first <= 1, "who wants no more gets no more");
  return 0;
}
