// Of which entries of a learned data sheet nobody knows whether they can be written.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include "../source_dir.hpp"
#include "base/format.hpp"
#include "drive/drive_settings.hpp"
#include "drive/new_family.hpp"
#include "drive/profile.hpp"
#include "od/learned_mark.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

std::string learned_variable(unsigned index, std::string_view access, std::string_view more = {}) {
  return formatted("[{0:04X}]\nParameterName=x\nObjectType=0x7\nDataType=0x7\nAccessType={1}\n{2}", index,
                   access, more);
}

std::string learned_text(std::string_view objects, std::string_view comment = od::kLearnedMark) {
  return formatted("[Comments]\nLines=1\nLine1={}\n{}", comment, objects);
}

class LearnedAccess : public testing::Test {
 protected:
  Profile profile_of(std::string_view text) {
    return profile_of_sheet(od::read_eds(text, "a.eds").value(), "a.eds", folders);
  }
  static bool is_unknown(const Profile& profile, std::uint16_t index) {
    return is_access_unknown(profile, *profile.dictionary.find({index, 0}));
  }

  std::vector<fs::path> folders{fs::path(source_dir()) / "eds"};
  std::string objects =
      learned_variable(0x1000, "ro", "DefaultValue=0x00020192\n") + learned_variable(0x1F80, "ro") +
      learned_variable(0x2001, "ro") + learned_variable(0x2002, "rw") + learned_variable(0x2003, "const") +
      learned_variable(0x6040, "rw") + learned_variable(0x6041, "ro") + learned_variable(0x6064, "ro") +
      learned_variable(0x60FF, "ro") + learned_variable(0x6700, "ro") + learned_variable(0x6841, "ro") +
      learned_variable(0x6864, "ro") + learned_variable(0x7064, "ro") + learned_variable(0xA000, "ro");
};

TEST_F(LearnedAccess, IsUnknownWhereNoStandardSaysThatItIsReadOnly) {
  const auto profile = profile_of(learned_text(objects));
  for (const unsigned index : {0x1F80U, 0x2001U, 0x60FFU, 0x6700U, 0x7064U, 0xA000U})
    EXPECT_TRUE(is_unknown(profile, static_cast<std::uint16_t>(index))) << formatted("{:04X}", index);
  for (const unsigned index : {0x1000U, 0x2002U, 0x2003U, 0x6040U, 0x6041U, 0x6064U, 0x6841U, 0x6864U})
    EXPECT_FALSE(is_unknown(profile, static_cast<std::uint16_t>(index))) << formatted("{:04X}", index);
}

TEST_F(LearnedAccess, IsKnownOfAFileThatWasNotLearned) {
  const auto profile = profile_of(learned_text(objects, "made by its maker"));
  EXPECT_TRUE(profile.unknown_access.empty());
}

TEST_F(LearnedAccess, OfAnotherProfileKnowsNoDriveObjects) {
  const auto profile =
      profile_of(learned_text(learned_variable(0x1000, "ro", "DefaultValue=0x00000191\n") +
                              learned_variable(0x6064, "ro") + learned_variable(0x2001, "ro")));
  EXPECT_TRUE(is_unknown(profile, 0x6064));
  EXPECT_FALSE(is_unknown(profile, 0x1000));
}

TEST_F(LearnedAccess, SettingsHaveWhatMayBeWritten) {
  const auto profile = profile_of(learned_text(objects));
  std::string undecided;
  for (const auto& setting : settings_of(profile))
    if (!setting.is_writable) undecided += to_string(setting.entry->address) + " ";
  EXPECT_EQ(undecided, "0x1F80:0 0x2001:0 0x60FF:0 0x6700:0 0x7064:0 0xA000:0 ");
}

TEST_F(LearnedAccess, StaysUnknownInAFamilyMadeOfTheFile) {
  const auto root = fs::temp_directory_path() / formatted("servoctl-learned-{}", ::getpid());
  const auto text = learned_text(objects);
  NewFamily family;
  family.name = "q1";
  const auto sheet = od::read_eds(text, "a.eds").value();
  const auto rules = rules_of_sheet(sheet, "a.eds", family);
  EXPECT_NE(std::find(family.open.begin(), family.open.end(), "access of the maker's objects"),
            family.open.end());
  EXPECT_NE(rules.find("# Decide: a.eds was learned from a drive"), std::string::npos) << rules;
  family.files.emplace_back("q1.toml", rules);
  family.files.emplace_back("q1.eds", text);
  folders.insert(folders.begin(), root);
  const auto place = write_family(family, root, folders);
  EXPECT_TRUE(place) << place.error().message.text();
  const auto profile = load_profile("q1", folders);
  fs::remove_all(root);
  ASSERT_TRUE(profile) << profile.error().message.text();
  EXPECT_TRUE(is_unknown(*profile, 0x2001));
  EXPECT_FALSE(is_unknown(*profile, 0x6841));
}

}  // namespace
}  // namespace servoctl::drive
