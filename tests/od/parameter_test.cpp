#include "od/parameter.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

constexpr std::string_view kHeader =
    "id,object,type,access,unit,scale,default,min,max,effect,enum,enum_zh,name,name_zh,group,flags,assumed,"
    "note,line\n";

Result<std::vector<Parameter>> parse(std::string_view rows) {
  return parse_parameters(std::string(kHeader) + std::string(rows), "p.csv");
}

void expect_refused(std::string_view rows, std::string_view message) {
  const auto parameters = parse(rows);
  ASSERT_FALSE(parameters) << rows;
  EXPECT_EQ(parameters.error().code, Errc::file);
  EXPECT_EQ(parameters.error().message, message);
}

TEST(Parameters, AreReadWhole) {
  const auto p = parse(
      "X1,0x2000:65,i16,rw,Hz,0.1,-5,-10,20,restart,0=Off;1=On,0=关;1=开,Gain,增益,loop,volatile "
      "mirror=0x1017:00,min,\"a, b\",77\n"
      "X2,,u8,wo,,,,,,immediate,,,Clear,清零,loop,command,,,78\n");
  ASSERT_TRUE(p) << p.error().message;
  ASSERT_EQ(p->size(), 2U);
  const auto& first = p->front();
  EXPECT_EQ(first.object, (ObjectAddress{0x2000, 0x65}));
  EXPECT_EQ(first.type, DataType::i16);
  EXPECT_EQ(first.scale, 0.1);
  EXPECT_EQ(to_string(*first.default_value), "-5");
  EXPECT_EQ(to_string(*first.max), "20");
  EXPECT_EQ(first.effect, Effect::restart);
  ASSERT_EQ(first.labels.size(), 2U);
  EXPECT_EQ(first.labels[1].label, "On");
  EXPECT_EQ(first.labels[1].label_zh, "开");
  EXPECT_EQ(first.mirror, (ObjectAddress{0x1017, 0}));
  EXPECT_TRUE(first.is_volatile);
  EXPECT_EQ(first.note, "a, b");
  EXPECT_EQ(first.line, 77U);
  const auto& second = p->back();
  EXPECT_FALSE(second.object);
  EXPECT_FALSE(second.min);
  EXPECT_TRUE(second.command);
  EXPECT_EQ(second.file_line, 3U);
}

TEST(Parameters, WithABadCellAreRefusedWithFileLineAndColumn) {
  expect_refused("X,0x20G0:1,u8,rw,,,,,,,,,N,,,,,,1\n",
                 "p.csv:2: column object: '0x20G0:1' is not an object such as 0x2000:01");
  expect_refused("X,,u9,rw,,,,,,,,,N,,,,,,1\n", "p.csv:2: column type: 'u9' is not a data type");
  expect_refused("X,,u8,rx,,,,,,,,,N,,,,,,1\n", "p.csv:2: column access: 'rx' is not ro, rw, wo or const");
  expect_refused("X,,u8,rw,,0,,,,,,,N,,,,,,1\n",
                 "p.csv:2: column scale: '0' is not a number other than zero");
  expect_refused("X,,u8,rw,,,300,,,,,,N,,,,,,1\n",
                 "p.csv:2: column default: '300' is not a value of u8: 300 does not fit u8 (0..255)");
  expect_refused("X,,u8,rw,,,,9,3,,,,N,,,,,,1\n", "p.csv:2: X: min is above max");
  expect_refused("X,,u8,rw,,,,,,soon,,,N,,,,,,1\n",
                 "p.csv:2: column effect: 'soon' is not immediate, restart, standstill or empty");
  expect_refused("X,,u8,rw,,,,,,,on,,N,,,,,,1\n",
                 "p.csv:2: column enum: 'on' is not a list such as 0=Off;1=On");
  expect_refused(
      "X,,u8,rw,,,,,,,0=a,1=b,N,,,,,,1\n",
      "p.csv:2: column enum_zh: '1=b' is not a list with the values of the English one (1 is not in it)");
  expect_refused("X,,u8,rw,,,,,,,0=a;0=b,,N,,,,,,1\n",
                 "p.csv:2: column enum: '0=a;0=b' is not a list without doubles (0 stands twice)");
  expect_refused("X,,u8,rw,,,,,,,,,N,,,shiny,,,1\n",
                 "p.csv:2: column flags: 'shiny' is not made of command, volatile and mirror=OBJECT");
  expect_refused("X,,u8,rw,,,,,,,,,,,,,,,1\n", "p.csv:2: X has no name");
  expect_refused(",,u8,rw,,,,,,,,,N,,,,,,1\n", "p.csv:2: a parameter without id");
  expect_refused("X,,u8,rw,,,,,,,,,N,,,,,,x\n", "p.csv:2: column line: 'x' is not a line number");
}

TEST(Parameters, ThatStandTwiceAreRefused) {
  expect_refused("X,,u8,rw,,,,,,,,,N,,,,,,1\nx,,u8,rw,,,,,,,,,M,,,,,,1\n", "p.csv:3: x stands here twice");
  expect_refused("X,0x2000:1,u8,rw,,,,,,,,,N,,,,,,1\nY,0x2000:01,u8,rw,,,,,,,,,M,,,,,,1\n",
                 "p.csv:3: Y: object 0x2000:1 belongs to another parameter as well");
}

TEST(Parameters, WithAnUnknownColumnAreRefused) {
  const auto p = parse_parameters("id,colour\nX,red\n", "p.csv");
  ASSERT_FALSE(p);
  EXPECT_EQ(p.error().message, "p.csv:1: column 'colour' is unknown");
}

Dictionary dictionary() {
  Dictionary d;
  Entry entry;
  entry.address = {0x6060, 0};
  entry.type = DataType::i8;
  d.add({0x6060, "Modes", ObjectCode::var, {entry}});
  return d;
}

TEST(Annotate, AddsWhatAnEdsCannotCarry) {
  auto d = dictionary();
  const auto done = annotate(d,
                             "object,unit,scale,effect,enum,enum_zh,name_zh,flags,note,line\n0x6060:00,rpm,0."
                             "1,standstill,1=pp,1=位置,模式,rpdo volatile,why,9\n",
                             "o.csv");
  ASSERT_TRUE(done) << done.error().message;
  const auto& e = *d.find({0x6060, 0});
  EXPECT_EQ(e.unit, "rpm");
  EXPECT_EQ(e.scale, 0.1);
  EXPECT_EQ(e.effect, Effect::standstill);
  EXPECT_EQ(e.pdo, PdoMapping::rpdo);
  EXPECT_TRUE(e.is_volatile);
  EXPECT_EQ(e.labels.front().label_zh, "位置");
  EXPECT_EQ(e.line, 9U);
}

TEST(Annotate, RefusesAnObjectTheDictionaryDoesNotHave) {
  auto d = dictionary();
  EXPECT_EQ(annotate(d, "object,unit\n0x6061:00,rpm\n", "o.csv").error().message,
            "o.csv:2: column object: '0x6061:00' is not an object of the dictionary");
  EXPECT_EQ(annotate(d, "object,flags\n0x6060:00,red\n", "o.csv").error().message,
            "o.csv:2: column flags: 'red' is not made of command, volatile, rpdo and tpdo");
}

}  // namespace
}  // namespace servoctl::od
