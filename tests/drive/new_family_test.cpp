// Families made from a data sheet and from tables as people have them.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "../source_dir.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "drive/assumed_unit.hpp"
#include "drive/family_mistakes.hpp"
#include "drive/new_family.hpp"
#include "foreign_sheet.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

class NewFamilies : public testing::Test {
 protected:
  NewFamilies() : root(fs::temp_directory_path() / ("servoctl-new-" + std::to_string(::getpid()))) {
    fs::create_directories(root);
    folders = {root / "drives", fs::path(source_dir()) / "eds"};
    family.name = "p10";
    family.files.emplace_back("p10.toml", rules_of_sheet(foreign_sheet(), "p10.eds", family));
    family.files.emplace_back("p10.eds", kForeignSheet);
  }
  ~NewFamilies() override { fs::remove_all(root); }

  std::size_t things() const {
    return static_cast<std::size_t>(std::distance(fs::recursive_directory_iterator(root), {}));
  }

  fs::path root;
  std::vector<fs::path> folders;
  NewFamily family;
};

TEST_F(NewFamilies, WhatIsWrittenPassesTheCheckAndIsRecognised) {
  const auto place = write_family(family, root / "drives", folders);
  ASSERT_TRUE(place) << place.error().message.text();
  const auto families = find_families(folders);
  const auto* found = find_family(families, "p10");
  ASSERT_NE(found, nullptr);
  for (const auto& mistake : mistakes_of(*found, folders))
    EXPECT_FALSE(mistake.breaks) << mistake.message.text();
  const auto profile = load_profile(*found, folders);
  ASSERT_TRUE(profile) << profile.error().message.text();
  EXPECT_EQ(profile->rules.vendor, "Maker \"A\"");
  EXPECT_FALSE(profile->rules.identity_certain) << "a person decides that";
  EXPECT_NE(std::find(family.open.begin(), family.open.end(), "[identity] certain"), family.open.end());
  EXPECT_EQ(profile->rules.identity.size(), 2U);
  EXPECT_FALSE(profile->rules.store.objects);
}

TEST_F(NewFamilies, TheRulesNameWhatTheDictionaryHasAndShowWhatHides) {
  auto other = foreign_sheet();
  other.device.vendor_name = "A\u202E\u009B2J";
  other.device.revision_number = 7;
  NewFamily made;
  made.name = "p11";
  const auto rules = rules_of_sheet(other, "p11.eds", made);
  EXPECT_EQ(made.identity.size(), 2U) << "there is no 1018h:03";
  EXPECT_NE(rules.find("vendor = \"A\\\\u202E\\\\u009B2J\""), std::string::npos) << rules;
}

TEST_F(NewFamilies, UnitsOfCia402StayOpen) {
  ASSERT_TRUE(write_family(family, root / "drives", folders));
  const auto made = load_profile("p10", folders);
  ASSERT_TRUE(made) << made.error().message.text();
  EXPECT_TRUE(leaves_units_open(*made));
  for (const auto* parent : {"p10", "p11"}) {
    // A family upon it, and one upon that.
    const auto name = formatted("p{}", parent[2] == '0' ? 11 : 12);
    ASSERT_TRUE(
        write_file_atomically(root / "drives" / (name + ".toml"),
                              formatted("format = 1\nfamily = \"{}\"\nparent = \"{}\"\n", name, parent)));
    const auto child = load_profile(name, folders);
    ASSERT_TRUE(child) << child.error().message.text();
    EXPECT_TRUE(leaves_units_open(*child)) << name;
    EXPECT_TRUE(child->descends_from("p10") && child->descends_from("cia402")) << name;
    EXPECT_FALSE(child->descends_from("gsd600")) << name;
  }
  const auto known = load_profile("gsd600", folders);
  ASSERT_TRUE(known);
  EXPECT_FALSE(leaves_units_open(*known)) << "its manual was read";
}

TEST_F(NewFamilies, AnExistingOneIsNotTouched) {
  ASSERT_TRUE(write_family(family, root / "drives", folders));
  const auto before = things();
  family.files.emplace_back("p10.faults.csv", "name\nA\n");
  const auto again = write_family(family, root / "drives", folders);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Errc::usage);
  EXPECT_EQ(things(), before);
}

TEST_F(NewFamilies, AnErrorLeavesNothingBehind) {
  family.files.emplace_back("p10.faults.csv", "nam\nA\n");
  const auto written = write_family(family, root / "drives", folders);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::file);
  EXPECT_NE(written.error().message.text().find("column 'name' is missing"), std::string::npos)
      << written.error().message.text();
  EXPECT_EQ(things(), 1U) << "the folder for families alone";
}

TEST_F(NewFamilies, ItsFolderHasTheModeOfNewFolders) {
  const auto before = ::umask(S_IWGRP | S_IRWXO);
  const auto place = write_family(family, root / "drives", folders);
  ::umask(before);
  ASSERT_TRUE(place) << place.error().message.text();
  EXPECT_EQ(fs::status(*place).permissions(), fs::perms(0750));
  EXPECT_EQ(std::distance(fs::directory_iterator(root), {}), 1) << "no draft is left";
}

TEST_F(NewFamilies, ATrialWithoutAFolderForItsDraftIsAnError) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "/tmp" : before;
  ::setenv("TMPDIR", (root / "none").c_str(), 1);
  const auto tried = try_family(family, root / "drives", folders);
  ::setenv("TMPDIR", kept.c_str(), 1);
  ASSERT_FALSE(tried);
  EXPECT_EQ(tried.error().code, Errc::file);
  EXPECT_NE(tried.error().message.text().find("$TMPDIR"), std::string::npos);
}

TEST_F(NewFamilies, ATrialFailsAsTheWritingWould) {
  const auto refused = [&](const fs::path& folder) {
    const auto tried = try_family(family, folder, folders);
    const auto written = write_family(family, folder, folders);
    EXPECT_FALSE(written);
    EXPECT_EQ(tried ? std::string() : tried.error().message,
              written ? std::string() : written.error().message);
  };
  const auto tried = try_family(family, root / "drives", folders);
  ASSERT_TRUE(tried) << tried.error().message.text();
  EXPECT_EQ(things(), 0U);
  ASSERT_TRUE(write_family(family, root / "drives", folders));
  refused(root / "drives");
  ASSERT_TRUE(write_file_atomically(root / "file", "x"));
  refused(root / "file/drives");
  family.name = "p11";
  family.files = {{"p11.toml", "format = 1\nfamily = \"p11\"\nwaers = true\n"}};
  refused(root / "drives");
}

TEST_F(NewFamilies, ANameIsOneThatFilesAndLinesCanHave) {
  for (const auto* name : {"p10", "lxd7-can", "a_1"}) EXPECT_TRUE(check_family_name(name)) << name;
  for (const auto* name :
       {"", "P10", "../x", "a b", "online", "1a", ".a", "a.eds", "check", "new", "all", "sim"})
    EXPECT_FALSE(check_family_name(name)) << name;
}

}  // namespace
}  // namespace servoctl::drive
