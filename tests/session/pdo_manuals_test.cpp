// The remap examples of the manuals, frame by frame as they are printed there. Numbers in comments are lines
// of the manuals.
#include "pdo_world.hpp"

namespace servoctl::session {
namespace {

using canopen::Pdo;
using Frames = std::vector<std::string>;

/// One PDO as a manual wants it.
struct Example {
  const char* pdo;
  std::vector<std::uint32_t> entries;
  Frames frames;
};

/// Maps something else first: the manuals write from the count 0 on, whatever stood there.
Pdo other_than(Pdo pdo) {
  const bool transmit = pdo.direction == canopen::PdoDirection::transmit;
  pdo.entries = {entry(transmit ? 0x60410010 : 0x60400010), entry(transmit ? 0x60640020 : 0x60FF0020)};
  return pdo;
}

void expect_frames(PdoWorld& world, const Example& example) {
  SCOPED_TRACE(example.pdo);
  ASSERT_FALSE(world.change({other_than(world.pdo(example.pdo))}).failure);
  auto pdo = world.pdo(example.pdo);
  pdo.entries.clear();
  for (const auto word : example.entries) pdo.entries.push_back(entry(word));
  const auto outcome = world.change({pdo});
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  Frames mapping;
  for (const auto& frame : world.sent) {
    const auto index = can::parse_frame(frame)->data[2];
    if (index == 0x16 || index == 0x1A) mapping.push_back(frame);
  }
  EXPECT_EQ(mapping, example.frames);
  EXPECT_EQ(world.pdo(example.pdo), pdo);
}

TEST(PdoManuals, TsMapsRpdosByTheirCountAlone) {
  PdoWorld world(PdoWorld::profile_of("ts"), 2);
  const Example examples[] = {
      {"RPDO1",  // 1727-1729, 1879-1881, 2000-2002
       {0x60400010},
       {"602#2F00160000000000", "602#2300160110004060", "602#2F00160001000000"}},
      {"RPDO2",  // 1734-1737, 1884-1887, 2005-2008
       {0x60830020, 0x60840020},
       {"602#2F01160000000000", "602#2301160120008360", "602#2301160220008460", "602#2F01160002000000"}},
      {"RPDO3",  // 1890-1892
       {0x60FF0020},
       {"602#2F02160000000000", "602#230216012000FF60", "602#2F02160001000000"}},
      {"RPDO3",  // 2011-2013
       {0x607A0020},
       {"602#2F02160000000000", "602#2302160120007A60", "602#2F02160001000000"}},
      {"RPDO4",  // 2016-2018
       {0x60810020},
       {"602#2F03160000000000", "602#2303160120008160", "602#2F03160001000000"}},
      {"TPDO1",  // 1753-1767
       {0x60410010},
       {"602#2F001A0000000000", "602#23001A0110004160", "602#2F001A0001000000"}},
      {"TPDO2",  // 1777-1792
       {0x60640020, 0x606C0020},
       {"602#2F011A0000000000", "602#23011A0120006460", "602#23011A0220006C60", "602#2F011A0002000000"}},
  };
  for (const auto& example : examples) {
    expect_frames(world, example);
    for (const auto& frame : world.sent) {
      const auto index = can::parse_frame(frame)->data[2];
      EXPECT_TRUE(index != 0x14 && index != 0x18) << frame;  // The COB-ID is not touched.
    }
  }
}

TEST(PdoManuals, TsSetsTimesAndTypeOfATpdoBehindItsMapping) {
  // 1768-1772 prints 2Fh (one byte) with two data bytes, 0190h "50 ms": the length is that of the objects.
  PdoWorld world(PdoWorld::profile_of("ts"), 2);
  auto pdo = world.pdo("TPDO1");
  pdo.entries = {entry(0x60410010)};
  pdo.event = std::uint16_t{0x0190};
  pdo.inhibit = std::uint16_t{0x0190};
  pdo.type = 254;
  ASSERT_FALSE(world.change({pdo}).failure);
  const Frames wanted{"602#2F001802FE000000", "602#2B00180390010000", "602#2B00180590010000"};
  ASSERT_GE(world.sent.size(), 3U);
  EXPECT_EQ(Frames(world.sent.end() - 3, world.sent.end()), wanted);
  EXPECT_EQ(world.sent[world.sent.size() - 4], "602#2F001A0001000000");
}

TEST(PdoManuals, Gsd600MapsWhatEveryModeRecommends) {
  PdoWorld world(PdoWorld::profile_of("gsd600"), 1);
  const Example examples[] = {
      {"RPDO1",  // pp, pv, pt, hm, ip: 6820-6822, 6911-6913, 7010-7012, 7357-7359, 7476-7478
       {0x60400010, 0x60600008},
       {"601#2F00160000000000", "601#2300160110004060", "601#2300160208006060", "601#2F00160002000000"}},
      {"RPDO2",  // pp: 6823-6825
       {0x607A0020, 0x60810020},
       {"601#2F01160000000000", "601#2301160120007A60", "601#2301160220008160", "601#2F01160002000000"}},
      {"RPDO2",  // pv: 6914-6915
       {0x60FF0020},
       {"601#2F01160000000000", "601#230116012000FF60", "601#2F01160001000000"}},
      {"RPDO2",  // pt: 7013-7014
       {0x60710010},
       {"601#2F01160000000000", "601#2301160110007160", "601#2F01160001000000"}},
      {"RPDO2",  // hm: 7360-7362
       {0x60980008, 0x609A0020},
       {"601#2F01160000000000", "601#2301160108009860", "601#2301160220009A60", "601#2F01160002000000"}},
      {"RPDO2",  // ip: 7479-7480; the word 60C10020h printed there has the wrong sub-index
       {0x60C10120},
       {"601#2F01160000000000", "601#230116012001C160", "601#2F01160001000000"}},
      {"RPDO3",  // pp: 6826-6828
       {0x60830020, 0x60840020},
       {"601#2F02160000000000", "601#2302160120008360", "601#2302160220008460", "601#2F02160002000000"}},
      {"RPDO3",  // hm: 7363-7365
       {0x60990120, 0x60990220},
       {"601#2F02160000000000", "601#2302160120019960", "601#2302160220029960", "601#2F02160002000000"}},
      {"TPDO1",  // all: 6829-6831
       {0x60410010, 0x60610008},
       {"601#2F001A0000000000", "601#23001A0110004160", "601#23001A0208006160", "601#2F001A0002000000"}},
      {"TPDO2",  // pp, pv, hm, ip: 6832-6834
       {0x60640020, 0x606C0020},
       {"601#2F011A0000000000", "601#23011A0120006460", "601#23011A0220006C60", "601#2F011A0002000000"}},
      {"TPDO2",  // pt: 7018-7020
       {0x60640020, 0x60770010},
       {"601#2F011A0000000000", "601#23011A0120006460", "601#23011A0210007760", "601#2F011A0002000000"}},
  };
  for (const auto& example : examples) expect_frames(world, example);
}

TEST(PdoManuals, Gsd600SwitchesAPdoOffAndOnByBit31Alone) {
  // 680-684, 936: TPDO1 is 0x40000181 with bit 30; only bit 31 may change.
  PdoWorld world(PdoWorld::profile_of("gsd600"), 1);
  auto pdo = world.pdo("TPDO1");
  pdo.type = 1;
  ASSERT_FALSE(world.change({pdo}).failure);
  EXPECT_EQ(world.sent, (Frames{"601#23001801810100C0", "601#2F00180201000000", "601#2300180181010040"}));
}

TEST(PdoManuals, Da200IsMappedOutsideOperational) {
  // 206, 1091; defaults 309-314, 321; 505: RPDO1 carries 60C1h:01 as its third object in the interpolated
  // mode.
  PdoWorld world(PdoWorld::profile_of("da200"), 1);
  auto pdo = world.pdo("RPDO1");
  EXPECT_EQ(pdo.entries, (std::vector{entry(0x60400010), entry(0x60600008), entry(0x607A0020)}));
  EXPECT_EQ(world.pdo("RPDO2").entries, (std::vector{entry(0x60FF0020), entry(0x60710010)}));
  EXPECT_EQ(world.pdo("TPDO1").entries,
            (std::vector{entry(0x60410010), entry(0x60610008), entry(0x60640020)}));
  EXPECT_EQ(world.pdo("TPDO2").entries,
            (std::vector{entry(0x606C0020), entry(0x60770010), entry(0x60780010)}));
  pdo.entries.back() = entry(0x60C10120);
  ASSERT_FALSE(world.change({pdo}).failure);
  EXPECT_EQ(world.sent, (Frames{"000#8001", "601#2300140101020080", "601#2F00160000000000",
                                "601#2300160110004060", "601#2300160208006060", "601#230016032001C160",
                                "601#2F00160003000000", "601#2300140101020000", "000#0101"}));
}

TEST(PdoManuals, Sv2AssignsOneOfItsFixedPdos) {
  PdoWorld world(PdoWorld::profile_of("sv2"), 1);
  // 530: 1702h
  EXPECT_EQ(world.pdo("RPDO259").entries,
            (std::vector{entry(0x60400010), entry(0x607A0020), entry(0x60FF0020), entry(0x60710010),
                         entry(0x60600008), entry(0x60B80010), entry(0x607F0020)}));
  const auto outcome = world.change({}, {}, {{{0x1C12, 0}, {1}}, {{0x1C12, 1}, {0x02, 0x17}}});
  ASSERT_FALSE(outcome.failure) << outcome.failure->message.text();
  // 546: 1C12h takes 1600h, 1701h to 1705h.
  ASSERT_GE(world.sent.size(), 2U);
  EXPECT_EQ(Frames(world.sent.end() - 2, world.sent.end()),
            (Frames{"601#2B121C0102170000", "601#2F121C0001000000"}));
}

}  // namespace
}  // namespace servoctl::session
