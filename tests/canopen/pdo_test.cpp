#include "canopen/pdo.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace servoctl::canopen
