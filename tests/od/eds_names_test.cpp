// Words an EDS may have where the book wants a number or another word.
#include <fmt/format.h>

#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

struct TypeRow {
  const char* name;
  std::uint64_t code;
};

constexpr TypeRow kTypes[] = {
    {"BOOLEAN", 0x01},      {"INTEGER8", 0x02},        {"INTEGER16", 0x03},   {"INTEGER32", 0x04},
    {"UNSIGNED8", 0x05},    {"UNSIGNED16", 0x06},      {"UNSIGNED32", 0x07},  {"REAL32", 0x08},
    {"OCTET_STRING", 0x0A}, {"VISIBLE_STRING", 0x09},  {"TIME_OF_DAY", 0x0C}, {"UNICODE_STRING", 0x0B},
    {"DOMAIN", 0x0F},       {"TIME_DIFFERENCE", 0x0D}, {"INTEGER24", 0x10},   {"REAL64", 0x11},
    {"INTEGER64", 0x15},    {"UNSIGNED24", 0x16},      {"UNSIGNED64", 0x1B}};

TEST(EdsType, HasTheNamesOfCia301) {
  for (const auto& row : kTypes) {
    const auto file = read(variable("2000", row.name, ""));
    ASSERT_NE(file.dictionary.find({0x2000, 0}), nullptr) << row.name;
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->type, data_type_from_cia(row.code)) << row.name;
    EXPECT_EQ(findings(file), Rules{"3:10 name-for-number"}) << row.name;
    EXPECT_EQ(file.diagnostics.front().remedy, fmt::format("write 0x{:04X}", row.code));
  }
}

TEST(EdsType, GivenByNameIsToldWithItsNumber) {
  const auto file = read(variable("2000", "unsigned64", ""));
  EXPECT_EQ(file.diagnostics.front().message, "DataType: 'unsigned64' is taken as 0x001B");
  EXPECT_EQ(file.diagnostics.front().remedy, "write 0x001B");
}

TEST(EdsType, IsANumberOf16Bits) {
  const auto good = variable("2FFF", "7", "");
  EXPECT_EQ(findings(read(variable("2000", "0xFFFF", "") + good)), Rules{"3:10 unknown-data-type"});
  EXPECT_EQ(findings(read(variable("2000", "0x10000", "") + good)), Rules{"3:10 bad-number"});
  EXPECT_EQ(findings(read(variable("2000", "none", "") + good)), Rules{"3:10 bad-number"});
  EXPECT_EQ(findings(read(variable("2000", "", "") + good)), Rules{"1:1 missing-data-type"});
}

TEST(EdsObjectType, HasTheNamesAndNumbersOfCia301) {
  const std::pair<const char*, ObjectCode> rows[] = {{"DOMAIN", ObjectCode::domain},
                                                     {"DEFTYPE", ObjectCode::deftype},
                                                     {"DEFSTRUCT", ObjectCode::defstruct},
                                                     {"VAR", ObjectCode::var},
                                                     {"ARRAY", ObjectCode::array},
                                                     {"RECORD", ObjectCode::record},
                                                     {"Variable", ObjectCode::var},
                                                     {"0x2", ObjectCode::domain},
                                                     {"5", ObjectCode::deftype},
                                                     {"0x06", ObjectCode::defstruct},
                                                     {"0x7", ObjectCode::var},
                                                     {"0x8", ObjectCode::array},
                                                     {"9", ObjectCode::record},
                                                     {"", ObjectCode::var}};
  for (const auto& row : rows) {
    const auto file =
        read(variable("2000", "7", "ObjectType=" + std::string(row.first)) + variable("2000sub0", "5", ""));
    ASSERT_NE(file.dictionary.object(0x2000), nullptr) << row.first;
    EXPECT_EQ(file.dictionary.object(0x2000)->code, row.second) << row.first;
  }
}

TEST(EdsObjectType, OfAnotherNumberIsToldAndTakenForVar) {
  for (const int code : {0, 1, 3, 4, 10, 255}) {
    const auto file = read(variable("2000", "7", "ObjectType=" + std::to_string(code)));
    EXPECT_EQ(findings(file), Rules{"5:12 unknown-object-type"}) << code;
    EXPECT_EQ(file.dictionary.object(0x2000)->code, ObjectCode::var);
  }
  EXPECT_EQ(findings(read(variable("2000", "7", "ObjectType=256"))), Rules{"5:12 bad-number"});
}

TEST(EdsAccess, HasAWordForEveryDirection) {
  struct Row {
    const char* word;
    Access access;
    PdoMapping pdo;
    bool of_the_book;
  };
  const Row rows[] = {{"ro", Access::ro, PdoMapping::tpdo, true},
                      {"rw", Access::rw, PdoMapping::both, true},
                      {"wo", Access::wo, PdoMapping::rpdo, true},
                      {"const", Access::constant, PdoMapping::tpdo, true},
                      {"rwr", Access::rw, PdoMapping::tpdo, true},
                      {"rww", Access::rw, PdoMapping::rpdo, true},
                      {"r", Access::ro, PdoMapping::tpdo, false},
                      {"w", Access::wo, PdoMapping::rpdo, false},
                      {"r/w", Access::rw, PdoMapping::both, false},
                      {"wr", Access::rw, PdoMapping::both, false},
                      {"ReadOnly", Access::ro, PdoMapping::tpdo, false},
                      {"WriteOnly", Access::wo, PdoMapping::rpdo, false},
                      {"ReadWrite", Access::rw, PdoMapping::both, false},
                      {"constant", Access::constant, PdoMapping::tpdo, false},
                      {"cons", Access::constant, PdoMapping::tpdo, false}};
  for (const auto& row : rows) {
    const auto file =
        read("[2000]\nParameterName=X\nDataType=7\nPDOMapping=1\nAccessType=" + std::string(row.word));
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->access, row.access) << row.word;
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->pdo, row.pdo) << row.word;
    EXPECT_EQ(findings(file), row.of_the_book ? Rules{} : Rules{"5:12 access-spelling"}) << row.word;
  }
}

TEST(EdsAccess, ThatIsNoneIsReadOnly) {
  const auto with = [](const char* word) {
    return read("[2000]\nParameterName=X\nDataType=7\nPDOMapping=1\nAccessType=" + std::string(word));
  };
  EXPECT_EQ(with("constxyz").diagnostics.front().remedy, "did you mean const?");
  EXPECT_EQ(with("whatever").diagnostics.front().remedy, "write ro, rw, wo, const, rwr or rww");
  EXPECT_EQ(with("whatever").diagnostics.front().message, "'whatever' is not an access type; taken as ro");
  for (const auto* word : {"whatever", ""}) {
    EXPECT_EQ(with(word).dictionary.find({0x2000, 0})->access, Access::ro);
    EXPECT_EQ(with(word).dictionary.find({0x2000, 0})->pdo, PdoMapping::tpdo);
    EXPECT_EQ(with(word).error_count(), 1U);
  }
}

TEST(EdsMapping, IsOnlyWhereItIsOne) {
  const std::pair<const char*, Rules> rows[] = {
      {"0", {}}, {"", {}}, {"2", {"5:12 bad-number"}}, {"yes", {"5:12 bad-number"}}};
  for (const auto& row : rows) {
    const auto file = read(variable("2000", "7", "PDOMapping=" + std::string(row.first)));
    EXPECT_EQ(file.dictionary.find({0x2000, 0})->pdo, PdoMapping::no) << row.first;
    EXPECT_EQ(findings(file), row.second) << row.first;
  }
}

}  // namespace
}  // namespace servoctl::od
