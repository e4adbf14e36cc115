#include "drive/shared_profile.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

/// A folder with the files of the GSD600, which a test may change.
class SharedProfile : public testing::Test {
 protected:
  SharedProfile() {
    fs::create_directories(folder_[0]);
    for (const auto& each : fs::directory_iterator(fs::path(source_dir()) / "eds/vmmore"))
      if (each.path().filename().string().starts_with("gsd600."))
        fs::copy(each.path(), folder_[0] / each.path().filename());
  }
  ~SharedProfile() override { fs::remove_all(folder_[0]); }

  Family family() const { return find_families(folder_).at(0); }
  void append(const std::string& text) const {
    std::ofstream(folder_[0] / "gsd600.toml", std::ios::app) << text;
  }

  const fs::path folder_[1] = {fs::temp_directory_path() / ("shared-profile-" + std::to_string(getpid()))};
};

TEST_F(SharedProfile, IsReadOnceAsLongAsItsFilesStayAsTheyAre) {
  const auto first = shared_profile("gsd600", folder_);
  const auto second = shared_profile("GSD600", folder_);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->get(), second->get());
  append("\n# another size\n");
  const auto third = shared_profile("gsd600", folder_);
  ASSERT_TRUE(third);
  EXPECT_NE(first->get(), third->get());
}

TEST_F(SharedProfile, RulesAreReadOnceAsLongAsTheirFileStaysAsItIs) {
  const auto first = shared_rules(family());
  const auto second = shared_rules(family());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->get(), second->get());
  append("\n[nonsense\n");
  EXPECT_FALSE(shared_rules(family())) << "a file that cannot be read any more";
  EXPECT_FALSE((*first)->identity.empty()) << "who has the rules keeps them";
}

TEST_F(SharedProfile, RulesThatCouldNotBeReadAreTriedAgain) {
  const auto text = (folder_[0] / "gsd600.toml").string();
  fs::rename(text, text + ".away");
  const Family gone{.name = "gsd600", .stem = folder_[0] / "gsd600"};
  EXPECT_FALSE(shared_rules(gone));
  fs::rename(text + ".away", text);
  EXPECT_TRUE(shared_rules(gone));
}

}  // namespace
}  // namespace servoctl::drive
