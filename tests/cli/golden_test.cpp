// Golden command-line cases: tests/cli/golden_cases.txt names them, and the files in tests/cli/golden/ hold
// what the program must say, as text and as JSON. `./dev golden` writes them anew; read the diff.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "golden_cases.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

/// What stands in a file of golden outputs, by the name of the case: a line `=== NAME` begins each.
std::map<std::string, std::string> said_in(const fs::path& path) {
  constexpr std::string_view kHead = "=== ";
  std::map<std::string, std::string> out;
  std::ifstream file(path);
  std::string* said = nullptr;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(kHead))
      said = &out[line.substr(kHead.size())];
    else if (said != nullptr)
      *said += line + "\n";
  return out;
}

void write_anew(const GoldenCase& c, std::string said) {
  auto all = said_in(c.file());
  all[c.name] = std::move(said);
  const auto cases = golden_cases();
  std::erase_if(all, [&](const auto& one) {
    return std::ranges::find(cases, one.first, &GoldenCase::name) == cases.end();
  });
  std::ofstream file(c.file());
  for (const auto& [name, text] : all) file << "=== " << name << "\n" << text;
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
  if (std::getenv("SERVOCTL_REWRITE_GOLDEN") != nullptr) return write_anew(GetParam(), said);
  EXPECT_EQ(said_in(GetParam().file())[GetParam().name], said)
      << "`./dev golden` writes " << GetParam().file() << " anew";
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, testing::ValuesIn(golden_cases()), golden_test_name);

TEST(GoldenCases, EveryOutputBelongsToACase) {
  std::map<std::string, fs::path> files;
  for (const auto& each : golden_cases()) files[each.name] = each.file();
  ASSERT_GT(files.size(), 40U);
  for (const auto& entry : fs::directory_iterator(golden_folder()))
    for (const auto& [name, said] : said_in(entry.path())) EXPECT_EQ(files[name], entry.path()) << name;
}

}  // namespace
}  // namespace servoctl::cli
