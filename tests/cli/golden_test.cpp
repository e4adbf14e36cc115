// Golden command-line cases: tests/cli/golden/cases.txt names them, one file each holds what the program must
// say, as text and as JSON. `./dev golden` writes the files anew; read the diff.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "golden_cases.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

std::string slurp(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

class Golden : public testing::TestWithParam<GoldenCase> {};

TEST_P(Golden, SaysWhatItSaidBefore) {
  fs::current_path(golden_source());
  ::setenv("SOURCE_DATE_EPOCH", "1795000000", 1);
  // Whole tables are long enough once.
  const bool table = GetParam().name.starts_with("table-") || GetParam().name.starts_with("commission-");
  const auto text = play_golden(GetParam(), "");
  const auto json = table ? PlayedGolden{} : play_golden(GetParam(), " --json");
  if (GetParam().name.starts_with("bad-")) {
    EXPECT_NE(text.exit, 0) << "a case that goes well is not called bad";
    EXPECT_NE(json.exit, 0) << "with --json";
  }
  const auto said = text.said + json.said;
  const auto path = golden_folder() / (GetParam().name + ".txt");
  if (std::getenv("SERVOCTL_REWRITE_GOLDEN") != nullptr) {
    std::ofstream(path) << said;
    return;
  }
  EXPECT_EQ(slurp(path), said) << "`./dev golden` writes " << path << " anew";
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, testing::ValuesIn(golden_cases()), golden_test_name);

TEST(GoldenCases, EveryFileBelongsToACase) {
  const auto cases = golden_cases();
  ASSERT_GT(cases.size(), 40U);
  for (const auto& entry : fs::directory_iterator(golden_folder())) {
    const auto stem = entry.path().stem().string();
    if (stem == "cases") continue;
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const GoldenCase& c) { return c.name == stem; }))
        << entry.path();
  }
}

}  // namespace
}  // namespace servoctl::cli
