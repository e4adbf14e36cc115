// SDO information of a simulated slave (ETG.1000.6, 5.6.3).
#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

class EscSdoInfoTest : public EscTest {
 protected:
  void start(std::size_t mailbox) {
    load();
    options_.coe.sdo_info = true;
    mailbox_ = mailbox;
    build(1);
    auto settings = hex("0010 0000 26 00 01 00");
    store_le(mailbox, std::span(settings).subspan(2, 2));
    EXPECT_EQ(write(0x0800, settings), 1);
    settings[1] = 0x14;
    settings[4] = 0x22;
    EXPECT_EQ(write(0x0808, settings), 1);
    ASSERT_EQ(request(2), "02 00 00 00 00 00");
  }
  std::string info(std::string_view request) {
    auto message = hex("0080");
    const auto body = hex(request);
    message.insert(message.end(), body.begin(), body.end());
    EXPECT_EQ(post(message), 1);
    return fetch_data();
  }
};

TEST_F(EscSdoInfoTest, ListsItsObjectsInAsManyPiecesAsItTakes) {
  start(64);
  std::vector<std::uint16_t> indexes;
  const auto all = profile_->dictionary.objects();
  const auto pieces = (2 + 2 * all.size() + 51) / 52;  // 64 less 6, 2 and 4.
  auto piece = hex(info("01 00 0000 0100"));
  for (std::size_t left = pieces; left > 0; --left) {
    ASSERT_GE(piece.size(), 6U);
    EXPECT_EQ(piece[2], left > 1 ? 0x82 : 0x02);
    EXPECT_EQ(load_le(ByteSpan(piece).subspan(4, 2)), left - 1);
    const std::size_t begin = left == pieces ? 8 : 6;
    if (left == pieces) {
      EXPECT_EQ(load_le(ByteSpan(piece).subspan(6, 2)), 1U);
    }
    for (auto at = begin; at < piece.size(); at += 2)
      indexes.push_back(static_cast<std::uint16_t>(load_le(ByteSpan(piece).subspan(at, 2))));
    if (left > 1) piece = hex(fetch_data());
  }
  EXPECT_EQ(fetch(), "");
  ASSERT_EQ(indexes.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(indexes[i], all[i].index);
}

TEST_F(EscSdoInfoTest, CountsItsLists) {
  start(256);
  const auto answer = hex(info("01 00 0000 0000"));
  ASSERT_EQ(answer.size(), 18U);
  EXPECT_EQ(to_hex(ByteSpan(answer).first(8)), "00 80 02 00 00 00 00 00");
  EXPECT_EQ(load_le(ByteSpan(answer).subspan(8, 2)), profile_->dictionary.objects().size());
  const auto receive = load_le(ByteSpan(answer).subspan(10, 2));
  EXPECT_EQ(hex(info("01 00 0000 0200")).size(), 8 + 2 * receive);
  EXPECT_EQ(info("01 00 0000 0600"), "00 80 07 00 00 00 30 00 09 06");
}

TEST_F(EscSdoInfoTest, DescribesAnObject) {
  start(256);
  const auto type = hex(info("03 00 0000 0010"));
  EXPECT_EQ(to_hex(ByteSpan(type).first(12)), "00 80 04 00 00 00 00 10 07 00 00 07");
  EXPECT_EQ(std::string(type.begin() + 12, type.end()), profile_->dictionary.object(0x1000)->name);
  EXPECT_EQ(to_hex(ByteSpan(hex(info("03 00 0000 1810"))).first(12)), "00 80 04 00 00 00 18 10 00 00 04 09");
  EXPECT_EQ(info("03 00 0000 3412"), "00 80 07 00 00 00 00 00 02 06");
}

TEST_F(EscSdoInfoTest, DescribesAnEntry) {
  start(256);
  // Controlword: u16, 16 bits, read and written in each state, in RxPDOs.
  const auto word = hex(info("05 00 0000 4060 00 00"));
  EXPECT_EQ(to_hex(ByteSpan(word).first(14)), "00 80 06 00 00 00 40 60 00 00 06 00 10 00");
  EXPECT_EQ(load_le(ByteSpan(word).subspan(14, 2)) & 0xFFU, 0x7FU);
  EXPECT_EQ(std::string(word.begin() + 16, word.end()), profile_->dictionary.find({0x6040, 0})->name);
  // Statusword: read only, in TxPDOs.
  EXPECT_EQ(to_hex(ByteSpan(hex(info("05 00 0000 4160 00 00"))).subspan(6, 10)),
            "41 60 00 00 06 00 10 00 87 00");
  // The vendor with its default; an assignment is written in PRE-OP alone.
  EXPECT_EQ(to_hex(ByteSpan(hex(info("05 00 0000 1810 01 10"))).subspan(6, 14)),
            "18 10 01 10 07 00 20 00 07 00 53 56 44 00");
  EXPECT_EQ(hex(info("05 00 0000 121C 01 00"))[14], 0x0F);
  EXPECT_EQ(info("05 00 0000 1810 09 00"), "00 80 07 00 00 00 11 00 09 06");
  EXPECT_EQ(info("05 00 0000 3412 00 00"), "00 80 07 00 00 00 00 00 02 06");
  EXPECT_EQ(info("09 00 0000 3412 00 00"), "00 80 07 00 00 00 01 00 04 05");
}

}  // namespace
}  // namespace servoctl::sim
