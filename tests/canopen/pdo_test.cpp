#include "canopen/pdo.hpp"

#include <gtest/gtest.h>

#include <map>

namespace servoctl::canopen {
namespace {

constexpr PdoEntry kControlword{{0x6040, 0}, 16};
constexpr PdoEntry kModes{{0x6060, 0}, 8};
constexpr PdoEntry kTarget{{0x607A, 0}, 32};

TEST(PdoEntry, IsIndexSubIndexAndLengthFromHighToLow) {
  EXPECT_EQ(mapping_of(kControlword), 0x6040'0010U);
  EXPECT_EQ(parse_pdo_entry(0x6099'0220), (PdoEntry{{0x6099, 2}, 32}));
}

TEST(Pdo, StandsAtTheIndexesOfItsNumber) {
  const Pdo rpdo{PdoDirection::receive, 3};
  EXPECT_EQ(rpdo.communication_index(), 0x1402);
  EXPECT_EQ(rpdo.mapping_index(), 0x1602);
  const Pdo tpdo{PdoDirection::transmit, 1};
  EXPECT_EQ(tpdo.communication_index(), 0x1800);
  EXPECT_EQ(tpdo.mapping_index(), 0x1A00);
}

TEST(Pdo, PacksItsEntriesOneAfterTheOtherLowByteFirst) {
  const PdoEntry entries[] = {kControlword, kModes, kTarget};
  const Bytes values[] = {{0x0F, 0x00}, {0x01}, {0x10, 0x27, 0x00, 0x00}};
  const auto data = pack_pdo(entries, values);
  EXPECT_EQ(data, (Bytes{0x0F, 0x00, 0x01, 0x10, 0x27, 0x00, 0x00}));
  const auto back = unpack_pdo(entries, data);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, (std::vector<Bytes>(std::begin(values), std::end(values))));
}

TEST(Pdo, CarriesSingleBitsAndGaps) {
  const PdoEntry entries[] = {{{0x2000, 1}, 1}, {{0x0005, 0}, 8}, {{0x2000, 2}, 3}, {{0x2000, 3}, 4}};
  const Bytes values[] = {{0x01}, {}, {0xFD}, {0x0A}};
  const auto data = pack_pdo(entries, values);
  EXPECT_EQ(data, (Bytes{0x01, 0xAA}));  // 1, eight 0, 101, 1010
  EXPECT_EQ(*unpack_pdo(entries, data), (std::vector<Bytes>{{0x01}, {}, {0x05}, {0x0A}}));
}

TEST(Pdo, ThatIsTooShortForItsMappingHasNoValues) {
  const PdoEntry entries[] = {kControlword, kTarget};
  EXPECT_FALSE(unpack_pdo(entries, Bytes{0x37, 0x06, 0x00}));
  EXPECT_TRUE(unpack_pdo(entries, Bytes(8)));
}

TEST(PdoName, StandsForDirectionAndNumber) {
  EXPECT_EQ(name(PdoDirection::transmit, 12), "TPDO12");
  const auto pdo = parse_pdo_name("rpdo3");
  ASSERT_TRUE(pdo);
  EXPECT_EQ(pdo->direction, PdoDirection::receive);
  EXPECT_EQ(pdo->communication_index(), 0x1402);
  EXPECT_EQ(parse_pdo_name("TPDO512")->mapping_index(), 0x1BFF);
  for (const auto* text : {"", "PDO1", "TPDO", "TPDO0", "TPDO513", "TPDO1x", "TPDO-1", "RPDO 1"})
    EXPECT_FALSE(parse_pdo_name(text)) << text;
}

TEST(PdoAt, KnowsTheFourRangesOfRecords) {
  EXPECT_FALSE(pdo_at(0x13FF));
  EXPECT_FALSE(pdo_at(0x1C00));
  for (std::uint16_t number = 1; number <= 512; ++number)
    for (const auto direction : {PdoDirection::receive, PdoDirection::transmit})
      for (const bool mapping : {false, true}) {
        const Pdo pdo{direction, number};
        const auto place = pdo_at(mapping ? pdo.mapping_index() : pdo.communication_index());
        ASSERT_TRUE(place);
        EXPECT_EQ(place->direction, direction);
        EXPECT_EQ(place->number, number);
        EXPECT_EQ(place->mapping, mapping);
      }
}

TEST(CanId, OfAnotherServiceIsNoneForAPdo) {
  // CiA 301, table 40, and the pre-defined connection set.
  for (const auto& [id, service] : std::map<std::uint32_t, std::string_view>{{0x000, "NMT"},
                                                                             {0x001, "a reserved service"},
                                                                             {0x07F, "a reserved service"},
                                                                             {0x080, "SYNC"},
                                                                             {0x081, "EMCY"},
                                                                             {0x0FF, "EMCY"},
                                                                             {0x100, "TIME"},
                                                                             {0x101, "a reserved service"},
                                                                             {0x180, "a reserved service"},
                                                                             {0x181, ""},
                                                                             {0x57F, ""},
                                                                             {0x580, ""},
                                                                             {0x581, "SDO"},
                                                                             {0x5FF, "SDO"},
                                                                             {0x600, ""},
                                                                             {0x601, "SDO"},
                                                                             {0x67F, "SDO"},
                                                                             {0x680, ""},
                                                                             {0x6DF, ""},
                                                                             {0x6E0, "a reserved service"},
                                                                             {0x6FF, "a reserved service"},
                                                                             {0x700, ""},
                                                                             {0x701, "error control"},
                                                                             {0x77F, "error control"},
                                                                             {0x780, "a reserved service"},
                                                                             {0x7FF, "a reserved service"}})
    EXPECT_EQ(service_of(id), service) << id;
}

}  // namespace
}  // namespace servoctl::canopen
