// The SII of a simulated slave, through its registers and word for word (ETG.1000.4, clause 6.4; ETG.1000.6,
// 5.4; ETG.2010).
#include <map>

#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

class EscSiiTest : public EscTest {
 protected:
  /// Eight bytes from a word on, as a master reads them.
  std::string words(std::uint32_t word) {
    auto command = hex("0001");
    const auto address = store_le(word, 4);
    command.insert(command.end(), address.begin(), address.end());
    EXPECT_EQ(write(0x0502, command), 1);
    return show(0x0508, 8);
  }
  Bytes image() {
    Bytes out;
    for (std::uint32_t word = 0; word < 1024; word += 4) {
      const auto part = hex(words(word));
      out.insert(out.end(), part.begin(), part.end());
    }
    return out;
  }
  /// The categories behind word 40h, by their type.
  std::map<unsigned, Bytes> categories() {
    const auto all = image();
    std::map<unsigned, Bytes> out;
    for (std::size_t at = 0x80;;) {
      const auto type = static_cast<unsigned>(load_le(ByteSpan(all).subspan(at, 2)));
      if (type == 0xFFFF) return out;
      const auto size = 2 * load_le(ByteSpan(all).subspan(at + 2, 2));
      if (at + 4 + size + 2 > all.size()) {
        out[0xFFFF] = {};
        return out;
      }
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at + 4);
      out[type] = Bytes(begin, begin + static_cast<std::ptrdiff_t>(size));
      at += 4 + size;
    }
  }
};

TEST_F(EscSiiTest, SaysWhoItIsAndWhereItsMailboxesAre) {
  options_ = {};
  load();
  options_.alias = 5;
  build(1);
  EXPECT_EQ(show(0x0502, 2), "40 00");
  EXPECT_EQ(words(0x00), "08 0C 00 00 00 00 00 00");
  EXPECT_EQ(words(0x04).substr(0, 17), "05 00 00 00 00 00");
  EXPECT_EQ(words(0x08), "53 56 44 00 01 00 00 00");
  EXPECT_EQ(words(0x0C), "01 00 00 00 01 00 00 00");
  EXPECT_EQ(words(0x14), "00 00 00 00 00 00 00 00");  // It cannot boot.
  EXPECT_EQ(words(0x18), "00 10 00 01 00 14 00 01");
  EXPECT_EQ(words(0x1C).substr(0, 5), "04 00");
  EXPECT_EQ(words(0x3C), "00 00 00 00 0F 00 01 00");
  EXPECT_EQ(words(0x400), "FF FF FF FF FF FF FF FF");
}

TEST(EscSii, TheChecksumIsThatOfOthersToo) {
  // dumps/eeprom/akd.hex and el2828.hex of ethercrab (MIT or Apache-2.0): the first words of real slaves.
  EXPECT_EQ(sii_crc(hex("0900 0008 0000 0000 0500 0000 0000")), 0x9D);
}

TEST_F(EscSiiTest, ItsCategoriesTellWhatItHas) {
  build(1);
  auto found = categories();
  ASSERT_EQ(found.size(), 6U);
  const std::string strings(found[10].begin(), found[10].end());
  EXPECT_EQ(strings.substr(1, 23), std::string("\x0FSINSEGYE drives\x06"
                                               "DSX00E"));
  EXPECT_EQ(
      to_hex(found[30]),
      "01 00 02 02 00 0D 00 00 00 00 00 00 00 00 00 00 11 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00");
  EXPECT_EQ(to_hex(found[40]), "01 02 03 00");
  EXPECT_EQ(
      to_hex(found[41]),
      "00 10 00 01 26 00 01 01 00 14 00 01 22 00 01 02 00 18 00 00 64 00 01 03 00 1C 00 00 20 00 01 04");
  // 1600h is empty; 1701h has four fixed objects.
  EXPECT_EQ(to_hex(ByteSpan(found[51]).subspan(0, 5)), "00 16 00 FF 00");
  EXPECT_EQ(to_hex(ByteSpan(found[51]).subspan(8, 5)), "01 17 04 FF 00");
  EXPECT_EQ(to_hex(ByteSpan(found[51]).subspan(14, 18)),
            "10 00 40 60 00 00 06 10 00 00 7A 60 00 00 04 20 00 00");
  EXPECT_EQ(to_hex(ByteSpan(found[50]).subspan(8, 3)), "01 1B 09");
}

TEST_F(EscSiiTest, SaysWhatItsCoeCanDo) {
  load();
  profile_->rules.coe.sdo_info = true;
  profile_->rules.coe.complete_access = true;
  build(1);
  EXPECT_EQ(categories()[30][5], 0x2F);
}

TEST_F(EscSiiTest, ReadsFourBytesAtATimeWhereItIsSetSo) {
  build(1);
  slave().registers().sii().eight_bytes = false;
  EXPECT_EQ(write(0x0502, "0001 08000000"), 1);
  EXPECT_EQ(show(0x0502, 14), "00 00 08 00 00 00 53 56 44 00 00 00 00 00");
}

TEST_F(EscSiiTest, IsBusyForAWhile) {
  build(1);
  slave().registers().sii().delay = milliseconds(2);
  EXPECT_EQ(write(0x0502, "0001 08000000"), 1);
  EXPECT_EQ(show(0x0502, 2), "40 81");
  EXPECT_EQ(write(0x0502, "0001 0A000000"), 0);  // Not heard.
  run(milliseconds(2));
  EXPECT_EQ(show(0x0502, 2), "40 00");
  EXPECT_EQ(show(0x0508, 4), "53 56 44 00");
}

TEST_F(EscSiiTest, IsWrittenWordByWordAndKeepsItWithoutPower) {
  build(1);
  EXPECT_EQ(write(0x0508, "3412"), 1);
  EXPECT_EQ(write(0x0502, "0002 04000000"), 1);  // The permission is missing.
  EXPECT_EQ(show(0x0502, 2), "40 40");
  EXPECT_EQ(write(0x0502, "0000"), 1);
  EXPECT_EQ(show(0x0502, 2), "40 00");
  EXPECT_EQ(write(0x0502, "0102 04000000"), 1);
  EXPECT_EQ(words(0x04).substr(0, 5), "34 12");
  EXPECT_EQ(show(0x0012, 2), "00 00");
  EXPECT_EQ(write(0x0502, "0004"), 1);  // Loaded anew, and the checksum is still that of before.
  EXPECT_EQ(show(0x0502, 2), "40 08");
  ring_.power_off(0);
  ring_.power_on(0, now_);
  EXPECT_EQ(datagram(kApwr, 0x0010'0000, store_le(kStation, 2)).counter, 1);
  EXPECT_EQ(words(0x04).substr(0, 5), "34 12");
}

TEST_F(EscSiiTest, BelongsToTheProcessorWhereThatWasGivenIt) {
  build(1);
  EXPECT_EQ(write(0x0500, "01"), 1);
  EXPECT_EQ(write(0x0502, "0001 08000000"), 0);
  EXPECT_EQ(write(0x0500, "02"), 1);
  EXPECT_EQ(write(0x0500, "00"), 1);
  EXPECT_EQ(words(0x08), "53 56 44 00 01 00 00 00");
}

TEST_F(EscSiiTest, ACommandItDoesNotKnowIsAnError) {
  build(1);
  EXPECT_EQ(write(0x0502, "0003 08000000"), 1);
  EXPECT_EQ(show(0x0502, 2), "40 20");
}

class BadSii : public EscSiiTest {
 protected:
  void build_with(SiiFault fault) {
    load();
    options_.sii = fault;
    options_.alias = 7;
    build(1);
  }
};

TEST_F(BadSii, AWrongChecksumIsToldAndTheAliasNotTaken) {
  build_with(SiiFault::checksum);
  EXPECT_EQ(show(0x0502, 2), "40 08");
  EXPECT_EQ(show(0x0012, 2), "00 00");
  EXPECT_EQ(words(0x08), "53 56 44 00 01 00 00 00");
}

TEST_F(BadSii, ABlankOneHasNothingInIt) {
  build_with(SiiFault::blank);
  EXPECT_EQ(show(0x0502, 2), "40 08");
  EXPECT_EQ(image(), Bytes(2048, 0xFF));
}

TEST_F(BadSii, ACategoryIsLongerThanTheMemory) {
  build_with(SiiFault::cut_short);
  EXPECT_EQ(categories().count(0xFFFF), 1U);
  EXPECT_EQ(categories().count(10), 1U);
}

TEST_F(BadSii, ItTellsOfMailboxesThatTheSlaveDoesNotTake) {
  build_with(SiiFault::mailboxes);
  EXPECT_EQ(words(0x18), "00 14 00 01 00 14 00 01");
  EXPECT_EQ(write(0x0800, "0014 0001 26 00 01 00"), 1);
  EXPECT_EQ(write(0x0808, "0014 0001 22 00 01 00"), 1);
  EXPECT_EQ(request(2), "11 00 00 00 16 00");
}

TEST_F(BadSii, AnEepromThatDoesNotAnswerIsAnError) {
  build_with(SiiFault::mute);
  EXPECT_EQ(show(0x0502, 2), "40 10");
  EXPECT_EQ(words(0x08), "00 00 00 00 00 00 00 00");
  EXPECT_EQ(show(0x0502, 2), "40 20");
  go_to_pre_op();
}

}  // namespace
}  // namespace servoctl::sim
