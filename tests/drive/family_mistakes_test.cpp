// All that is wrong in the files of a family, at once.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "../source_dir.hpp"
#include "drive/family_mistakes.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

class FamilyMistakes : public testing::Test {
 protected:
  FamilyMistakes() : folder(fs::temp_directory_path() / ("servoctl-mistakes-" + std::to_string(::getpid()))) {
    fs::create_directories(folder);
    folders = {folder, fs::path(source_dir()) / "eds"};
  }
  ~FamilyMistakes() override { fs::remove_all(folder); }

  void write(std::string_view name, std::string_view text) const { std::ofstream(folder / name) << text; }
  std::vector<Mistake> found() const { return mistakes_of({"p10", folder / "p10"}, folders); }
  std::string messages() const {
    std::string out;
    for (const auto& mistake : found()) out += mistake.message.text() + "\n";
    return out;
  }

  fs::path folder;
  std::vector<fs::path> folders;
};

constexpr std::string_view kSoundRules = "format = 1\nfamily = \"p10\"\nparent = \"cia402\"\n";

TEST_F(FamilyMistakes, TheFamiliesOfTheProgramHaveNone) {
  const auto families = find_families(std::span(folders).last(1));
  ASSERT_FALSE(families.empty());
  for (const auto& family : families)
    for (const auto& mistake : mistakes_of(family, folders)) ADD_FAILURE() << mistake.message.text();
}

TEST_F(FamilyMistakes, OfTheRulesAllAreNamedWithTheirLine) {
  write(
      "p10.toml",
      "format = 1\nfamily = \"p11\"\nwaers = true\n[store]\nobjects = 1\n[nmt]\nneeds = 3\n[[caution]]\ntxt = \"a\"\n");
  EXPECT_EQ(messages(),
            "p10.toml: family = \"p11\"\n"
            "p10.toml:3:1: unknown key 'waers'\n"
            "p10.toml:5:11: 'objects' cannot be 1\n"
            "p10.toml:7:9: 'needs' cannot be 3\n"
            "p10.toml:9:1: unknown key 'txt'\n");
  EXPECT_EQ(found()[2].remedy, "write true or false");
  EXPECT_EQ(found()[2].line, 5U);
  EXPECT_EQ(found()[3].remedy, R"(write [{ name = "P1-01", value = 1 }])");
  EXPECT_EQ(found()[4].remedy, "did you mean text?");
}

TEST_F(FamilyMistakes, OfTheTablesAllAreNamedWithTheirLine) {
  write("p10.toml", kSoundRules);
  write("p10.params.csv", "id,type,access,name,colour\nA1,u9,rx,N,\nA2,u8,rw,,\nA1,u8,rw,N,\nA3,u8\n");
  write("p10.faults.csv", "code,kind,nam\n0x12345,oops,x\n");
  write("p10.words.csv", "thing,words\n");
  EXPECT_EQ(
      messages(),
      "p10.params.csv:1: column 'colour' is unknown\n"
      "p10.params.csv:2: column 'type': 'u9' is not a data type: bool, i8, i16, i24, i32, i64, u8, u16, u24, "
      "u32, u64, f32, f64, string, bytes, domain or time\n"
      "p10.params.csv:2: column 'access': 'rx' is not ro, rw, wo or const\n"
      "p10.params.csv:3: A2 has no name\n"
      "p10.params.csv:4: A1 appears twice\n"
      "p10.params.csv:5: 2 cells, but the header names 5 columns\n"
      "p10.faults.csv:1: column 'nam' is unknown\n"
      "p10.faults.csv:1: column 'name' is missing\n"
      "p10.words.csv:1: the columns are not thing,words,manual\n");
}

TEST_F(FamilyMistakes, WhatNewFamiliesAreRefusedForIsFoundInOnesThatAreThere) {
  write("p10.toml", kSoundRules);
  write("p10.params.csv", "id,type,access,default,max,name\nA1,u8,rw,9,5,N\n");
  write("p10.faults.csv", "code,name\n2310,A\n0x3210,B\n0x3210,C\n");
  EXPECT_EQ(messages(),
            "p10.params.csv:2: A1: the default 9 is above the maximum 5 (raw numbers)\n"
            "p10.faults.csv:2: column 'code': '2310' is not a hexadecimal code of 16 bits, such as 0x8130\n"
            "p10.faults.csv:4: 0x3210 is in line 3 as well\n");
  EXPECT_EQ(count_errors(found()), 3U);
  write("p10.fault.csv", "");
  EXPECT_EQ(count_errors(found()), 3U) << "a warning breaks nothing";
}

TEST_F(FamilyMistakes, NamesInTheRulesAreLookedUp) {
  write("p10.toml",
        std::string(kSoundRules) +
            "[store]\nunlock = \"A9\"\nlocked = [\"A1\", \"A8\"]\n[motion]\nencoder = \"0x6063\"\n");
  write("p10.params.csv", "id,type,access,name\nA1,u8,rw,N\n");
  EXPECT_EQ(messages(),
            "p10.toml:5:10: 'unlock' names A9, which is neither a parameter nor an object\n"
            "p10.toml:6:17: 'locked' names A8, which is neither a parameter nor an object\n");
}

TEST_F(FamilyMistakes, ARowThatIsWrongIsKnownToTheRules) {
  write("p10.toml", std::string(kSoundRules) + "[store]\nunlock = \"A1\"\n");
  write("p10.params.csv", "id,type,access,name\nA1,u9,rw,N\n");
  EXPECT_EQ(found().size(), 1U) << messages();
}

TEST_F(FamilyMistakes, AParameterStandsInTheDataSheetInItsSize) {
  write("p10.toml", kSoundRules);
  write("p10.eds",
        "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2001\n[2001]\nParameterName=Gain\nObjectType=0x7\n"
        "DataType=0x0006\nAccessType=rw\nPDOMapping=0\n");
  write("p10.params.csv", "id,object,type,access,name\nA1,0x2001:00,u32,rw,N\nA2,0x2002:00,u16,rw,N\n");
  std::string errors;
  for (const auto& mistake : found())
    if (mistake.breaks) errors += mistake.message.text() + "\n";
  EXPECT_EQ(errors,
            "p10.params.csv:2: A1: type u32, but 0x2001:0 is u16 in the data sheet\n"
            "p10.params.csv:3: A2: object 0x2002:0 is not in the data sheet\n");
}

TEST_F(FamilyMistakes, ATypeOfAnotherSignAndNumbersThatAreOneOrHideAnObjectAreNamed) {
  write("p10.toml", kSoundRules);
  write("p10.eds",
        "[ManufacturerObjects]\nSupportedObjects=2\n1=0x2001\n2=0x2002\n[2001]\nParameterName=Gain\n"
        "ObjectType=0x7\nDataType=0x0006\nAccessType=rw\nPDOMapping=0\n[2002]\nParameterName=Ramp\n"
        "ObjectType=0x7\nDataType=0x0006\nAccessType=rw\nPDOMapping=0\n");
  write("p10.params.csv", "id,object,type,access,name\nA1,0x2001:00,i16,rw,N\n");
  EXPECT_NE(messages().find("p10.params.csv:2: A1: type i16, but 0x2001:0 is u16 in the data sheet\n"),
            std::string::npos)
      << messages();
  write("p10.params.csv",
        "id,object,type,access,name\nA1,0x2001:00,u16,rw,N\nA-01,,u16,rw,N\nRamp,,u16,rw,N\n");
  EXPECT_NE(messages().find("p10.params.csv:3: A-01 is the same parameter number as A1 in line 2\n"),
            std::string::npos)
      << messages();
  EXPECT_NE(messages().find("p10.params.csv:4: number 'Ramp' is the name of object 0x2002:0\n"),
            std::string::npos)
      << messages();
  const auto loaded = load_profile("p10", folders);
  ASSERT_FALSE(loaded) << "one number for two parameters";
  EXPECT_NE(loaded.error().message.text().find("A-01 is the same parameter number as A1 in line 2"),
            std::string::npos);
}

TEST_F(FamilyMistakes, AFileThatIsNotReadOrNoUtf8IsNamed) {
  write("p10.toml", kSoundRules);
  write("p10.fault.csv", "");
  write("p10.faults.csv", "name\nok\n\xCB\xD9\n");
  const auto all = found();
  ASSERT_EQ(all.size(), 2U) << messages();
  EXPECT_EQ(all[0].message, "p10.faults.csv:3: this is not UTF-8");
  EXPECT_EQ(all[1].message, "p10.fault.csv is not read");
  EXPECT_FALSE(all[1].breaks);
}

TEST_F(FamilyMistakes, AFileMayBuildOnTheFamilyOfItsName) {
  write("p10.toml", kSoundRules);
  fs::create_directories(folder / "own/inner");
  write("own/inner/p10.toml", "format = 1\nfamily = \"p10\"\nparent = \"p10\"\n");
  const auto loaded = load_profile((folder / "own/inner/p10.toml").string(), folders);
  EXPECT_TRUE(loaded) << loaded.error().message.text();
}

TEST_F(FamilyMistakes, AParentThatIsMissingOrALoopIsOne) {
  write("p10.toml", "format = 1\nfamily = \"p10\"\nparent = \"cia40\"\n");
  EXPECT_EQ(messages(), "p10.toml: parent: no drive family is called 'cia40'\n");
  write("p10.toml", "format = 1\nfamily = \"p10\"\nparent = \"p10\"\n");
  EXPECT_EQ(messages(), "p10.toml: parent = \"p10\": the parents form a loop: p10 → p10\n");
  write("p11.toml", "format = 1\nfamily = \"p11\"\nparent = \"p10\"\n");
  write("p10.toml", "format = 1\nfamily = \"p10\"\nparent = \"p11\"\n");
  EXPECT_EQ(messages(), "p10.toml: parent = \"p11\": the parents form a loop: p10 → p11 → p10\n");
  const auto loaded = load_profile("p10", folders);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().message.text(),
            "p10.toml: parent = \"p11\": the parents form a loop: p10 → p11 → p10");
}

}  // namespace
}  // namespace servoctl::drive
