#include "drive/topics.hpp"

#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto topics = drive::parse_topics(fuzz::text(data, size), "fuzz.topics.toml", "fuzz");
  if (!topics) {
    fuzz::require(topics.error().code == Errc::file, "topics that cannot be read are Errc::file");
    return 0;
  }
  for (const auto& topic : *topics) {
    fuzz::require(!topic.name.empty() && !topic.title.empty(), "a topic has a name and a title");
    fuzz::require(drive::is_source_line(topic.line), "a topic says where it stands");
    for (const auto& row : topic.rows)
      fuzz::require(row.cells.size() == topic.columns.size(), "a row has a cell for each column");
  }
  return 0;
}
