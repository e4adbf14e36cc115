#include "od/parameter.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

constexpr std::string_view kHeader =
    "id,object,type,access,unit,scale,default,min,max,effect,enum,enum_zh,name,name_zh,group,flags,assumed,"
    "note,note_zh,line\n";

Result<std::vector<Parameter>> parse(std::string_view rows) {
  return parse_parameters(std::string(kHeader) + std::string(rows), "p.csv");
}

void expect_refused(std::string_view rows, std::string_view message) {
  const auto parameters = parse(rows);
  ASSERT_FALSE(parameters) << rows;
  EXPECT_EQ(parameters.error().code, Errc::file);
  EXPECT_EQ(parameters.error().message.text(), message);
}

TEST(Parameters, AreReadWhole) {
  const auto p = parse(
      "X1,0x2000:65,i16,rw,Hz,0.1,-5,-10,20,restart,0=Off;1=On,0=关;1=开,Gain,增益,loop,volatile "
      "mirror=0x1017:00,min,\"a, b\",甲,77\n"
      "X2,,u8,wo,,,,,,immediate,,,Clear,清零,loop,command,,,,78\n");
  ASSERT_TRUE(p) << p.error().message.text();
  ASSERT_EQ(p->size(), 2U);
  const auto& first = p->front();
  EXPECT_EQ(first.id, "X1");
  EXPECT_EQ(first.access, Access::rw);
  EXPECT_EQ(first.unit, "Hz");
  EXPECT_EQ(to_string(*first.min), "-10");
  EXPECT_EQ(first.labels[0].value, 0);
  EXPECT_EQ(first.name, "Gain");
  EXPECT_EQ(first.name_zh, "增益");
  EXPECT_EQ(first.group, "loop");
  EXPECT_TRUE(first.doubts.about("min"));
  EXPECT_EQ(first.note_zh, "甲");
  EXPECT_FALSE(first.command);
  EXPECT_EQ(first.file_line, 2U);
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
  EXPECT_FALSE(second.mirror);
  EXPECT_TRUE(second.command);
  EXPECT_FALSE(second.is_volatile);
  EXPECT_EQ(second.access, Access::wo);
  EXPECT_EQ(second.effect, Effect::immediate);
  EXPECT_EQ(second.scale, 1);
  EXPECT_EQ(second.line, 78U);
  EXPECT_EQ(second.file_line, 3U);
}

TEST(Parameters, WithABadCellAreRefusedWithFileLineAndColumn) {
  expect_refused("X,0x20G0:1,u8,rw,,,,,,,,,N,,,,,,,1\n",
                 "p.csv:2: column 'object': '0x20G0:1' is not an object such as 0x2000:01");
  expect_refused(
      "X,,u9,rw,,,,,,,,,N,,,,,,,1\n",
      "p.csv:2: column 'type': 'u9' is not a data type: bool, i8, i16, i24, i32, i64, u8, u16, u24, u32, u64, f32, f64, "
      "string, bytes, domain or time");
  expect_refused("X,,u8,rx,,,,,,,,,N,,,,,,,1\n", "p.csv:2: column 'access': 'rx' is not ro, rw, wo or const");
  expect_refused("X,,u8,rw,,0,,,,,,,N,,,,,,,1\n",
                 "p.csv:2: column 'scale': '0' is not a number other than zero");
  expect_refused("X,,u8,rw,,,300,,,,,,N,,,,,,,1\n",
                 "p.csv:2: column 'default': '300' is not a value of u8: 300 does not fit u8 (0..255)");
  expect_refused("X,,u8,rw,,,,9,3,,,,N,,,,,,,1\n", "p.csv:2: X: min is above max");
  expect_refused("X,,u8,rw,,,,,,soon,,,N,,,,,,,1\n",
                 "p.csv:2: column 'effect': 'soon' is not immediate, restart, standstill or empty");
  expect_refused("X,,u8,rw,,,,,,,on,,N,,,,,,,1\n",
                 "p.csv:2: column 'enum': 'on' is not a list such as 0=Off;1=On");
  expect_refused(
      "X,,u8,rw,,,,,,,0=a,1=b,N,,,,,,,1\n",
      "p.csv:2: column 'enum_zh': '1=b' is not a list with the values of the English one (1 is not in it)");
  expect_refused("X,,u8,rw,,,,,,,0=a;0=b,,N,,,,,,,1\n",
                 "p.csv:2: column 'enum': '0=a;0=b' is not a list without doubles (0 appears twice)");
  expect_refused("X,,u8,rw,,,,,,,,,N,,,shiny,,,,1\n",
                 "p.csv:2: column 'flags': 'shiny' is not made of command, volatile and mirror=OBJECT");
  expect_refused("X,,u8,rw,,,,,,,,,,,,,,,,1\n", "p.csv:2: X has no name");
  expect_refused(",,u8,rw,,,,,,,,,N,,,,,,,1\n", "p.csv:2: a parameter without id");
  expect_refused("X,,u8,rw,,,,,,,,,N,,,,,,,x\n", "p.csv:2: column 'line': 'x' is not a line number");
}

TEST(Parameters, ThatStandTwiceAreRefused) {
  expect_refused("X,,u8,rw,,,,,,,,,N,,,,,,,1\nx,,u8,rw,,,,,,,,,M,,,,,,,1\n", "p.csv:3: x appears twice");
  expect_refused("X,0x2000:1,u8,rw,,,,,,,,,N,,,,,,,1\nY,0x2000:01,u8,rw,,,,,,,,,M,,,,,,,1\n",
                 "p.csv:3: Y: object 0x2000:1 belongs to another parameter as well");
}

TEST(Parameters, WithAnUnknownColumnAreRefused) {
  const auto p = parse_parameters("id,colour\nX,red\n", "p.csv");
  ASSERT_FALSE(p);
  EXPECT_EQ(p.error().message.text(), "p.csv:1: column 'colour' is unknown");
}

/// What is wrong with a table of these columns and one row.
std::string refused(std::string_view columns, std::string_view cells) {
  const auto p = parse_parameters(
      "id,type,access,name," + std::string(columns) + "\nX,u8,rw,N," + std::string(cells) + "\n", "p.csv");
  return p ? "" : p.error().message.text();
}

TEST(Parameters, MayHaveAnyNumberInTheirCells) {
  EXPECT_EQ(refused("line", "4294967295"), "");
  EXPECT_EQ(refused("line", "4294967296"), "p.csv:2: column 'line': '4294967296' is not a line number");
  EXPECT_EQ(refused("scale", "-0.5"), "");
  EXPECT_EQ(refused("scale", "x"), "p.csv:2: column 'scale': 'x' is not a number other than zero");
  EXPECT_EQ(refused("min,max", "3,3"), "");
  EXPECT_EQ(refused("min,max", ",3"), "");
  EXPECT_EQ(refused("min,max", "4,3"), "p.csv:2: X: min is above max");
  EXPECT_EQ(refused("default,min", "1,2"), "p.csv:2: X: the default 1 is below the minimum 2 (raw numbers)");
  EXPECT_EQ(refused("default,max", "4,3"), "p.csv:2: X: the default 4 is above the maximum 3 (raw numbers)");
  EXPECT_EQ(refused("default,min,max", "3,3,3"), "");
  EXPECT_EQ(refused("flags", "mirror="),
            "p.csv:2: column 'flags': 'mirror=' is not flags with an object after mirror=");
  EXPECT_EQ(refused("flags", "command  volatile"), "");
}

TEST(Parameters, HaveLabelsWithANumberAndAText) {
  EXPECT_EQ(refused("enum", " -1 = a ;0x10=b"), "");
  EXPECT_EQ(refused("enum,enum_zh", "1=a;2=b,2=甲"), "");
  for (const auto* cell : {"1", "1=", "=a", "x=a", "1=a=b", "1=a;", "9223372036854775808=a"})
    EXPECT_EQ(refused("enum", cell),
              "p.csv:2: column 'enum': '" + std::string(cell) + "' is not a list such as 0=Off;1=On");
  EXPECT_EQ(refused("enum,enum_zh", "1=a,x"),
            "p.csv:2: column 'enum_zh': 'x' is not a list such as 0=关;1=开");
  const auto p = parse_parameters("id,type,access,name,enum,enum_zh\nX,u8,rw,N,-1=a;0x10=b,16=甲\n", "p.csv");
  ASSERT_TRUE(p);
  ASSERT_EQ(p->front().labels.size(), 2U);
  EXPECT_EQ(p->front().labels[0].value, -1);
  EXPECT_EQ(p->front().labels[0].label_zh, "");
  EXPECT_EQ(p->front().labels[1].value, 16);
  EXPECT_EQ(p->front().line, 0U);
  EXPECT_EQ(p->front().labels[1].label_zh, "甲");
}

TEST(Parameters, AreRefusedWithTheirFirstFault) {
  const auto p = parse_parameters("id,type,access,name,line\n\nX,u9,rx,,y\n", "p.csv");
  ASSERT_FALSE(p);
  EXPECT_EQ(
      p.error().message.text(),
      "p.csv:3: column 'type': 'u9' is not a data type: bool, i8, i16, i24, i32, i64, u8, u16, u24, u32, u64, f32, f64, "
      "string, bytes, domain or time");
  EXPECT_EQ(p.error().line, 3U);
}

TEST(Parameters, InATableThatIsNoneAreRefused) {
  EXPECT_EQ(parse_parameters("", "p.csv").error().code, Errc::file);
  const auto p = parse_parameters("id,tpye\n", "p.csv");
  EXPECT_EQ(p.error().code, Errc::file);
  EXPECT_EQ(p.error().line, 1U);
  EXPECT_EQ(p.error().hint.text(), "did you mean type?");
  EXPECT_EQ(parse_parameters("id,\n", "p.csv").error().message.text(), "p.csv:1: column '' is unknown");
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
  const auto done =
      annotate(d,
               "object,unit,scale,effect,enum,enum_zh,name_zh,flags,assumed,note,line\n0x6060:00,"
               "rpm,0.1,standstill,1=pp,1=位置,模式,rpdo volatile,unit,why,9\n",
               "o.csv");
  ASSERT_TRUE(done) << done.error().message.text();
  const auto& e = *d.find({0x6060, 0});
  EXPECT_EQ(e.unit, "rpm");
  EXPECT_EQ(e.scale, 0.1);
  EXPECT_EQ(e.effect, Effect::standstill);
  EXPECT_EQ(e.pdo, PdoMapping::rpdo);
  EXPECT_TRUE(e.is_volatile);
  EXPECT_EQ(e.labels.front().label_zh, "位置");
  EXPECT_EQ(e.line, 9U);
  EXPECT_EQ(e.name_zh, "模式");
  EXPECT_TRUE(e.doubts.about("unit"));
  EXPECT_EQ(e.note, "why");
  EXPECT_FALSE(e.command);
}

TEST(Annotate, KnowsEveryFlag) {
  const std::pair<const char*, PdoMapping> rows[] = {{"", PdoMapping::no},
                                                     {"rpdo", PdoMapping::rpdo},
                                                     {"tpdo", PdoMapping::tpdo},
                                                     {"tpdo  rpdo", PdoMapping::both},
                                                     {"command", PdoMapping::no}};
  for (const auto& row : rows) {
    auto d = dictionary();
    ASSERT_TRUE(annotate(d, "object,flags\n0x6060:00," + std::string(row.first) + "\n", "o.csv"));
    EXPECT_EQ(d.find({0x6060, 0})->pdo, row.second) << row.first;
    EXPECT_EQ(d.find({0x6060, 0})->command, row.first == std::string("command"));
    EXPECT_FALSE(d.find({0x6060, 0})->is_volatile);
    EXPECT_EQ(d.find({0x6060, 0})->scale, 1);
  }
}

TEST(Annotate, KnowsTheLeastThatIsMoreThanNothing) {
  auto d = dictionary();
  ASSERT_TRUE(annotate(d, "object,flags\n0x6060:00,least=1000 volatile\n", "o.csv"));
  EXPECT_EQ(d.find({0x6060, 0})->least, 1000U);
  EXPECT_TRUE(d.find({0x6060, 0})->is_volatile);
  for (const char* flag : {"least=", "least=x", "least=-1", "least"})
    EXPECT_FALSE(annotate(d, std::string("object,flags\n0x6060:00,") + flag + "\n", "o.csv")) << flag;
}

TEST(Annotate, NamesAnObjectOfSeveralEntries) {
  Dictionary d;
  Entry count;
  count.address = {0x6099, 0};
  Entry speed;
  speed.address = {0x6099, 1};
  d.add({0x6099, "Homing speeds", ObjectCode::array, {count, speed}});
  const auto done =
      annotate(d, "object,unit,name_zh,line\n0x6099,,回零速度,7\n0x6099:00,,子索引数,8\n", "o.csv");
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_EQ(d.object(0x6099)->name_zh, "回零速度");
  EXPECT_EQ(d.find({0x6099, 0})->name_zh, "子索引数");
  EXPECT_EQ(d.find({0x6099, 1})->name_zh, "");
  EXPECT_EQ(annotate(d, "object,unit\n0x6099,rpm\n", "o.csv").error().message.text(),
            "o.csv:2: column 'unit': 'rpm' is not empty in the line of an object without a sub-index");
}

TEST(Annotate, RefusesAnObjectTheDictionaryDoesNotHave) {
  auto d = dictionary();
  EXPECT_EQ(annotate(d, "object,unit\n0x6061:00,rpm\n", "o.csv").error().message.text(),
            "o.csv:2: column 'object': '0x6061:00' is not an object of the dictionary");
  EXPECT_EQ(annotate(d, "object,unit\n,rpm\n", "o.csv").error().message.text(),
            "o.csv:2: column 'object': '' is not an object of the dictionary");
  EXPECT_EQ(annotate(d, "object,colour\n", "o.csv").error().message.text(),
            "o.csv:1: column 'colour' is unknown");
  EXPECT_EQ(annotate(d, "", "o.csv").error().code, Errc::file);
  EXPECT_EQ(annotate(d, "object,flags\n0x6060:00,red\n", "o.csv").error().message.text(),
            "o.csv:2: column 'flags': 'red' is not made of command, volatile, rpdo, tpdo and least=NUMBER");
}

}  // namespace
}  // namespace servoctl::od
