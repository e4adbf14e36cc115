#include "od/eds_section.hpp"

#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

/// `kind index sub decimal` of the name; empty when it is none.
std::string parsed(std::string_view text) {
  const auto name = parse_section_name(text);
  if (!name) return {};
  const std::string decimal = name->decimal_sub ? std::to_string(*name->decimal_sub) : "-";
  return std::to_string(static_cast<int>(name->kind)) + " " + std::to_string(name->index) + " " +
         std::to_string(name->sub) + " " + decimal;
}

std::string of_kind(SectionKind kind, int index = 0) {
  return std::to_string(static_cast<int>(kind)) + " " + std::to_string(index) + " 0 -";
}

TEST(SectionName, OfAnObjectIsItsIndex) {
  EXPECT_EQ(parsed("1018"), of_kind(SectionKind::object, 0x1018));
  EXPECT_EQ(parsed("ffff"), of_kind(SectionKind::object, 0xFFFF));
  EXPECT_EQ(parsed("1"), of_kind(SectionKind::object, 1));
  for (const auto* none : {"11018", "10G8", "", "1018x", "x1018", "-1"}) EXPECT_EQ(parsed(none), "") << none;
}

TEST(SectionName, OfASubIndexHasItInBothReadings) {
  const auto sub = [](int value, const char* decimal) {
    return std::to_string(static_cast<int>(SectionKind::sub)) + " 4120 " + std::to_string(value) + " " +
           decimal;
  };
  EXPECT_EQ(parsed("1018sub0"), sub(0, "0"));
  EXPECT_EQ(parsed("1018SUB1f"), sub(0x1F, "-"));
  EXPECT_EQ(parsed("1018Sub10"), sub(0x10, "10"));
  EXPECT_EQ(parsed("1018sub255"), sub(0x255, "255"));
  EXPECT_EQ(parsed("1018sub0FF"), sub(0xFF, "-"));
  EXPECT_EQ(parsed("1018sub100"), sub(0x100, "100"));
  for (const auto* none : {"1018sub", "1018sub256", "1018sub1000", "1018sub0001", "1018subFFF", "1018sub10A",
                           "1018sob1", "1018s", "sub1", "11018sub1", "1018subG"})
    EXPECT_EQ(parsed(none), "") << none;
}

TEST(SectionName, MayBeOneOfTheBook) {
  const std::pair<const char*, SectionKind> rows[] = {{"MandatoryObjects", SectionKind::list},
                                                      {"optionalobjects", SectionKind::list},
                                                      {"ManufacturerObjects", SectionKind::list},
                                                      {"DeviceInfo", SectionKind::device_info},
                                                      {"DeviceComissioning", SectionKind::commissioning},
                                                      {"DeviceCommissioning", SectionKind::commissioning},
                                                      {"DUMMYUSAGE", SectionKind::dummies},
                                                      {"FileInfo", SectionKind::other},
                                                      {"Comments", SectionKind::other},
                                                      {"Tools", SectionKind::other},
                                                      {"DynamicChannels", SectionKind::other},
                                                      {"StandardDataTypes", SectionKind::other},
                                                      {"SupportedModules", SectionKind::other},
                                                      {"ConnectedModules", SectionKind::other},
                                                      {"Tool1", SectionKind::other},
                                                      {"tool9", SectionKind::other},
                                                      {"Tool0", SectionKind::other},
                                                      {"M1ModuleInfo", SectionKind::other},
                                                      {"m0comments", SectionKind::other},
                                                      {"M99FixedObjects", SectionKind::other},
                                                      {"M9SubExtends", SectionKind::other},
                                                      {"M1SubExt6000sub0", SectionKind::other},
                                                      {"M1Fixed6000", SectionKind::other}};
  for (const auto& row : rows) EXPECT_EQ(parsed(row.first), of_kind(row.second)) << row.first;
  for (const auto* none :
       {"Tool", "Toolx", "Tool/", "Tool:", "M1", "M", "MModuleInfo", "M1Module", "M1xModuleInfo", "FileInf"})
    EXPECT_EQ(parsed(none), "") << none;
}

TEST(SectionName, MayBelongToAnObject) {
  EXPECT_EQ(parsed("2000Name"), of_kind(SectionKind::names, 0x2000));
  EXPECT_EQ(parsed("2000value"), of_kind(SectionKind::values, 0x2000));
  EXPECT_EQ(parsed("2000Denotation"), of_kind(SectionKind::denotations, 0x2000));
  EXPECT_EQ(parsed("2000ObjectLinks"), of_kind(SectionKind::other, 0x2000));
  EXPECT_EQ(parsed("2000SubObjLinks"), of_kind(SectionKind::other, 0x2000));
  EXPECT_EQ(parsed("2Name"), of_kind(SectionKind::names, 2));
  for (const auto* none : {"Name", "20000Name", "2000Names", "2000Nam", "G000Name"})
    EXPECT_EQ(parsed(none), "") << none;
}

TEST(SectionName, ThatIsMisspeltIsRespeltWhenSomethingIsNear) {
  const std::pair<const char*, const char*> rows[] = {
      {"0x1018_sub1", "1018sub1"}, {"0X1018", "1018"},
      {"10-18.sub 1", "1018sub1"}, {"1018sbu1", "1018sub1"},
      {"1018su1", nullptr},        {"1018sob12", "1018sub12"},
      {"1018suv1", "1018sub1"},    {"1018xyb1", nullptr},
      {"1018sbuG", nullptr},       {"ManufactuerObjects", "ManufacturerObjects"},
      {"Coment", "Comments"},      {"Toolz", "Tools"},
      {"Tols", nullptr},           {"12000", nullptr},
      {"Parameters", nullptr}};
  for (const auto& row : rows)
    EXPECT_EQ(respelt_section_name(row.first),
              row.second == nullptr ? std::nullopt : std::optional<std::string>(row.second))
        << row.first;
}

TEST(SectionName, ThatIsLongIsNotRespelt) {
  const auto spaced = [](std::size_t size) { return "2000" + std::string(size - 4, ' '); };
  EXPECT_EQ(respelt_section_name(spaced(40)), "2000");
  EXPECT_EQ(respelt_section_name(spaced(41)), std::nullopt);
}

TEST(LearnedMark, IsFoundAsEditorsWriteTheComment) {
  constexpr std::string_view kObject = "[2001]\nParameterName=x\nObjectType=7\nDataType=7\nAccessType=ro\n";
  for (const std::string comment :
       {"[Comments]\nLines=1\nLine1=servoctl-learned: access, sign and limits\n",
        "[Comments]\r\nLines=2\r\nLine1=a\r\nLine2 = servoctl-learned: access\r\n",
        "[comments]\nLine1 =   servoctl-learned\n"})
    EXPECT_TRUE(read_sheet(comment + std::string(kObject)).learned) << comment;
  for (const std::string other : {"", "[Comments]\nLine1=it was not servoctl-learned: it is the maker's\n",
                                  "[Tools]\nLine1=servoctl-learned: x\n", ";Line1=servoctl-learned: x\n"})
    EXPECT_FALSE(read_sheet(other + std::string(kObject)).learned) << other;
}

}  // namespace
}  // namespace servoctl::od
