#include "ethercat/coe_info.hpp"

#include "messages.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

class CoeInfoTest : public testing::Test {
 protected:
  Result<CoeInfo::Description> result() {
    auto first = info.take_result();
    EXPECT_TRUE(first) << "it has not ended";
    EXPECT_FALSE(info.busy());
    EXPECT_EQ(info.deadline(), kNever);
    return first ? *first : Result<CoeInfo::Description>(fail(Errc::bug, "none"));
  }
  template <class T>
  T got() {
    const auto r = result();
    EXPECT_TRUE(r) << (r ? "" : r.error().message.text());
    return r ? std::get<T>(*r) : T{};
  }
  void expect_failure(Errc code, std::string_view message) {
    const auto r = result();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code);
    EXPECT_EQ(r.error().message.text(), message);
    EXPECT_EQ(r.error().node, 2);
  }
  void list(std::initializer_list<std::string_view> lines) {
    info.start_list(ObjectList::all, now);
    play(info, now, lines);
  }

  CoeInfo info{2, 500ms};
  TimePoint now{1s};
};

using List = std::vector<std::uint16_t>;

TEST_F(CoeInfoTest, ListsTheObjectsOfOneMessage) {
  list({"> 0080 01000000 0100", "< 0080 02000000 0100 0010 0110 4160"});
  EXPECT_EQ(got<List>(), (List{0x1000, 0x1001, 0x6041}));
}

TEST_F(CoeInfoTest, ListsTheObjectsOfSeveralParts) {
  list({"> 0080 01000000 0100", "< 0080 82000200 0100 0010", "+ 400ms", "< 0080 82000100 0110 1810",
        "+ 400ms", "< 0080 02000000 4160"});
  EXPECT_EQ(got<List>(), (List{0x1000, 0x1001, 0x1018, 0x6041}));
}

TEST_F(CoeInfoTest, APartThatIsMissingIsTold) {
  list({"> 0080 01000000 0100", "< 0080 82000300 0100 0010", "< 0080 82000100 0110"});
  expect_failure(Errc::protocol,
                 "node 2: the list of its objects: part 2 from the end of its answer is missing");
  list({"> 0080 01000000 0100", "< 0080 82000300 0100 0010", "+ 500ms"});
  expect_failure(Errc::timeout, "node 2: the list of its objects: its answer stopped 3 parts before its end");
}

TEST_F(CoeInfoTest, DescribesAnObject) {
  info.start_object(0x1018, now);
  play(info, now, {"> 0080 03000000 1810", "< 0080 04000000 1810 2300 04 09 4964656E74697479"});
  const auto object = got<CoeObject>();
  EXPECT_EQ(object.index, 0x1018);
  EXPECT_EQ(object.data_type, 0x23);
  EXPECT_EQ(object.max_sub, 4);
  EXPECT_EQ(object.code, 9);
  EXPECT_EQ(object.name, "Identity");
}

TEST_F(CoeInfoTest, DescribesAnEntry) {
  info.start_entry({0x1018, 1}, now);
  play(info, now,
       {"> 0080 05000000 1810 01 07", "< 0080 06000000 1810 01 07 0700 2000 0700 56656E646F7200CC"});
  auto entry = got<CoeEntry>();
  EXPECT_EQ(entry.object, (ObjectAddress{0x1018, 1}));
  EXPECT_EQ(entry.data_type, 7);
  EXPECT_EQ(entry.bits, 32);
  EXPECT_EQ(entry.access, kEntryReadPreop | kEntryReadSafeop | kEntryReadOp);
  EXPECT_EQ(entry.name, "Vendor");
  // With a unit and a default value in front of the name, though nobody asked for them.
  info.start_entry({0x1018, 1}, now);
  play(info, now,
       {"> 0080 05000000 1810 01 07", "< 0080 06000000 1810 01 1F 0600 1000 3F00 0102 2A00 56656E646F72"});
  EXPECT_EQ(got<CoeEntry>().name, "Vendor");
}

TEST_F(CoeInfoTest, ADriveWithoutADictionaryRefusesInOneWayOrAnother) {
  list({"> 0080 01000000 0100", "< 0080 07000000 00000106"});
  expect_failure(
      Errc::sdo_abort,
      "node 2: the list of its objects: refused: unsupported access to an object (abort 0x06010000)");
  list({"> 0080 01000000 0100", "< 0030 80 000000 01000405"});
  expect_failure(
      Errc::sdo_abort,
      "node 2: the list of its objects: refused: command specifier not valid or unknown (abort 0x05040001)");
  list({"> 0080 01000000 0100"});
  info.on_refusal(4);
  expect_failure(
      Errc::protocol,
      "node 2: the list of its objects: its mailbox refuses the request: the service is not supported (mailbox error 0004h)");
  list({"> 0080 01000000 0100", "+ 500ms"});
  expect_failure(Errc::timeout, "node 2: the list of its objects: no answer within 500 ms");
  info.start_object(0x1000, now);
  play(info, now, {"> 0080 03000000 0010", "< 0080 07000000 0000"});
  expect_failure(Errc::protocol, "node 2, object 0x1000:0: its description: refused without a code");
}

TEST_F(CoeInfoTest, WhatBelongsToAnotherQuestionIsNoAnswer) {
  info.start_entry({0x1018, 1}, now);
  play(info, now,
       {"> 0080 05000000 1810 01 07", "< 0080 06000000 1810 02 07 0700 2000 0700 41",
        "< 0080 04000000 1810 2300 04 09 41", "< 0080 02000000 0100 0010", "< 0030 4B 181001 00000000",
        "< 0080", "< 0010 FF81 11 0000000000", "< 0080 06000000 1810"});
  EXPECT_TRUE(info.busy());
  EXPECT_FALSE(info.take_result());
}

TEST_F(CoeInfoTest, ADescriptionThatIsTooShortIsTold) {
  info.start_entry({0x1018, 1}, now);
  play(info, now, {"> 0080 05000000 1810 01 07", "< 0080 06000000 1810 01 07 0700"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:1: its description: it is too short");
  info.start_object(0x1018, now);
  play(info, now, {"> 0080 03000000 1810", "< 0080 04000000 1810 23"});
  expect_failure(Errc::protocol, "node 2, object 0x1018:0: its description: it is too short");
}

}  // namespace
}  // namespace servoctl::ethercat
