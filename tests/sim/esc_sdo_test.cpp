// CoE of a simulated slave against a client of a few lines (ETG.1000.6, 5.6.2).
#include <algorithm>

#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

/// An object of any length that the test adds.
constexpr ObjectAddress kText{0x5FFF, 0};

class EscSdo : public EscTest {
 protected:
  void SetUp() override {
    load();
    od::Object text{kText.index, "Text", od::ObjectCode::var, {}};
    text.entries.emplace_back();
    text.entries[0].address = kText;
    text.entries[0].type = od::DataType::string;
    profile_->dictionary.add(std::move(text));
  }
  /// In PRE-OP, with mailboxes of this size.
  void start(std::size_t mailbox) {
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
  Bytes ask(const Bytes& request) {
    Bytes message = hex("0020");
    message.insert(message.end(), request.begin(), request.end());
    EXPECT_EQ(post(message), 1);
    const auto answer = hex(fetch_data());
    if (answer.size() < 3) return {};
    return Bytes(answer.begin() + 2, answer.end());
  }

  /// An upload, with as many segments as it takes.
  Bytes upload(ObjectAddress object, unsigned command = 0x40) {
    segments_ = 0;
    auto answer = ask({static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(object.index),
                       static_cast<std::uint8_t>(object.index >> 8U), object.sub, 0, 0, 0, 0});
    if ((answer[0] & 0xE0U) != 0x40) return {};
    if ((answer[0] & 2U) != 0) return Bytes(answer.begin() + 4, answer.end() - (answer[0] >> 2U & 3U));
    const auto total = load_le(ByteSpan(answer).subspan(4, 4));
    Bytes out(answer.begin() + 8, answer.end());
    for (unsigned toggle = 0; out.size() < total; toggle ^= 0x10U, ++segments_) {
      answer = ask({static_cast<std::uint8_t>(0x60U | toggle), 0, 0, 0, 0, 0, 0, 0});
      EXPECT_EQ(answer[0] & 0xF0U, toggle);
      EXPECT_GE(answer.size(), 8U);
      const auto unused = answer.size() == 8 ? answer[0] >> 1U & 7U : 0U;
      out.insert(out.end(), answer.begin() + 1, answer.end() - unused);
      EXPECT_EQ((answer[0] & 1U) != 0, out.size() >= total);
    }
    EXPECT_EQ(out.size(), total);
    return out;
  }
  /// A normal download; the abort code, or 0.
  std::uint32_t download(ObjectAddress object, const Bytes& data, unsigned command = 0x21) {
    segments_ = 0;
    Bytes request{static_cast<std::uint8_t>(command),
                  static_cast<std::uint8_t>(object.index),
                  static_cast<std::uint8_t>(object.index >> 8U),
                  object.sub,
                  0,
                  0,
                  0,
                  0};
    store_le(data.size(), std::span(request).subspan(4, 4));
    auto sent = std::min(data.size(), mailbox_ - 16);
    request.insert(request.end(), data.begin(), data.begin() + static_cast<std::ptrdiff_t>(sent));
    auto answer = ask(request);
    for (unsigned toggle = 0; answer[0] != 0x80 && sent < data.size(); toggle ^= 0x10U, ++segments_) {
      const auto here = std::min(data.size() - sent, mailbox_ - 9);
      request.assign(1, static_cast<std::uint8_t>(toggle));
      const auto begin = data.begin() + static_cast<std::ptrdiff_t>(sent);
      request.insert(request.end(), begin, begin + static_cast<std::ptrdiff_t>(here));
      sent += here;
      if (here < 7) request[0] |= static_cast<std::uint8_t>((7 - here) << 1U);
      if (sent == data.size()) request[0] |= 1;
      request.resize(std::max<std::size_t>(request.size(), 8));
      answer = ask(request);
      if (answer[0] != 0x80) {
        EXPECT_EQ(answer[0], 0x20U | toggle);
      }
    }
    return answer[0] == 0x80 ? static_cast<std::uint32_t>(load_le(ByteSpan(answer).subspan(4, 4))) : 0U;
  }

  std::size_t segments_ = 0;
};

TEST_F(EscSdo, ReadsAndWritesFourBytesAtOnce) {
  start(256);
  EXPECT_EQ(sdo("40 0010 00 00000000"), "00 30 43 00 10 00 92 01 04 00");
  EXPECT_EQ(sdo("40 4160 00 00000000"), "00 30 4B 41 60 00 50 02 00 00");
  EXPECT_EQ(sdo("2F 6060 00 03000000"), "00 30 60 60 60 00 00 00 00 00");
  EXPECT_EQ(sdo("40 6160 00 00000000"), "00 30 4F 61 60 00 03 00 00 00");
  EXPECT_EQ(sdo("23 FF60 00 10270000"), "00 30 60 FF 60 00 00 00 00 00");
  EXPECT_EQ(slave().model().values().number({0x60FF, 0}), 10000U);
}

TEST_F(EscSdo, ALongerValueHasItsSizeInFront) {
  start(256);
  EXPECT_EQ(sdo("40 0810 00 00000000"), "00 30 41 08 10 00 06 00 00 00 44 53 58 30 30 45");
  EXPECT_EQ(sdo("21 FF5F 00 05000000 48656C6C6F"), "00 30 60 FF 5F 00 00 00 00 00");
  EXPECT_EQ(sdo("40 FF5F 00 00000000"), "00 30 41 FF 5F 00 05 00 00 00 48 65 6C 6C 6F");
  EXPECT_EQ(sdo("21 FF60 00 04000000 01020304"), "00 30 60 FF 60 00 00 00 00 00");
}

TEST_F(EscSdo, AnySizeGoesThroughAnyMailbox) {
  for (const std::size_t mailbox : {34U, 35U, 40U, 128U, 256U}) {
    slaves_.clear();
    ring_ = {};
    counter_ = 0;
    start(mailbox);
    for (std::size_t size = 1; size < 300; size += size < 70 ? 1 : 13) {
      Bytes data(size);
      for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>('0' + i % 70);
      ASSERT_EQ(download(kText, data), 0U) << size << " in " << mailbox;
      const auto more = size > mailbox - 16 ? size - (mailbox - 16) : 0;
      EXPECT_EQ(segments_, (more + mailbox - 10) / (mailbox - 9));
      ASSERT_EQ(upload(kText), data) << size << " in " << mailbox;
      EXPECT_EQ(segments_, size <= 4 ? 0 : (more + mailbox - 10) / (mailbox - 9));
    }
  }
}

TEST_F(EscSdo, AnEmptyValueHasTheSizeZero) {
  start(64);
  EXPECT_EQ(sdo("40 FF5F 00 00000000"), "00 30 41 FF 5F 00 00 00 00 00");
}

TEST_F(EscSdo, ARefusalIsARequestOrAResponseAsItIsSet) {
  start(256);
  EXPECT_EQ(sdo("40 3412 00 00000000"), "00 20 80 34 12 00 00 00 02 06");
  slaves_.clear();
  ring_ = {};
  options_.coe.abort_service = 3;
  start(256);
  EXPECT_EQ(sdo("40 3412 00 00000000"), "00 30 80 34 12 00 00 00 02 06");
}

TEST_F(EscSdo, EachRefusalHasItsCode) {
  start(34);
  struct Row {
    const char* request;
    const char* code;
  };
  const Row rows[] = {
      {"40 1810 09 00000000", "11 00 09 06"},  // No such sub-index.
      {"2B 4160 00 00000000", "02 00 01 06"},  // Read-only.
      {"21 4160 00 02000000 0000", "02 00 01 06"},
      {"21 4160 00 64000000 0000", "02 00 01 06"},  // Before all of it has come.
      {"2B 6060 00 03000000", "10 00 07 06"},       // Two bytes for one.
      {"2F 6060 00 63000000", "31 00 09 06"},       // No such mode: above the last,
      {"2F 6060 00 05000000", "30 00 09 06"},       // and between two.
      {"50 0016 00 00000000", "00 00 01 06"},       // Complete access.
      {"31 0016 00 02000000 0000", "00 00 01 06"},
      {"60 0000 00 00000000", "01 00 04 05"},  // A segment of nothing.
      {"00 0000 00 00000000", "01 00 04 05"},
      {"A0 0010 00 00000000", "01 00 04 05"},         // A block.
      {"20 FF5F 00 00000000", "01 00 04 05"},         // Without a size.
      {"21 FF5F 00 01000000 414243", "12 00 07 06"},  // More than it says.
  };
  for (const auto& row : rows) {
    const auto answer = sdo(row.request);
    EXPECT_EQ(answer.substr(0, 8), "00 20 80") << row.request;
    EXPECT_EQ(answer.substr(18), row.code) << row.request;
  }
}

TEST_F(EscSdo, ASegmentOutOfTurnEndsTheTransfer) {
  start(34);
  ASSERT_EQ(download(kText, Bytes(60, 'x')), 0U);
  EXPECT_EQ(sdo("40 FF5F 00 00000000").substr(6, 2), "41");
  EXPECT_EQ(sdo("70 0000 00 00000000").substr(18), "00 00 03 05");  // The wrong toggle bit.
  EXPECT_EQ(sdo("60 0000 00 00000000").substr(18), "01 00 04 05");
  EXPECT_EQ(sdo("21 FF5F 00 14000000 414243").substr(6, 2), "60");
  EXPECT_EQ(sdo("10 4142434445464748").substr(18), "00 00 03 05");
  EXPECT_EQ(sdo("21 FF5F 00 14000000 414243").substr(6, 2), "60");
  EXPECT_EQ(sdo("01 4142434445464748").substr(18), "13 00 07 06");  // The last, and too little.
  EXPECT_EQ(sdo("21 FF5F 00 05000000 414243").substr(6, 2), "60");
  EXPECT_EQ(sdo("01 4142434445464748").substr(18), "12 00 07 06");
  EXPECT_EQ(slave().model().values().get(kText), Bytes(60, 'x'));
}

TEST_F(EscSdo, AnAbortOfTheClientEndsTheTransferAndIsNotAnswered) {
  start(34);
  ASSERT_EQ(download(kText, Bytes(60, 'x')), 0U);
  EXPECT_EQ(sdo("40 FF5F 00 00000000").substr(6, 2), "41");
  EXPECT_EQ(sdo("80 FF5F 00 00000405"), "");
  EXPECT_EQ(sdo("60 0000 00 00000000").substr(18), "01 00 04 05");
  EXPECT_EQ(upload(kText), Bytes(60, 'x'));
}

TEST_F(EscSdo, CompleteAccessTakesAllSubIndicesWhereItIsThere) {
  options_.coe.complete_access = true;
  start(34);
  EXPECT_EQ(to_hex(upload({0x1018, 0}, 0x50)), "04 00 53 56 44 00 01 00 00 00 01 00 00 00 01 00 00 00");
  EXPECT_EQ(to_hex(upload({0x1018, 1}, 0x50)), "53 56 44 00 01 00 00 00 01 00 00 00 01 00 00 00");
  EXPECT_EQ(segments_, 0U);
  EXPECT_EQ(upload({0x1704, 0}, 0x50).size(), 2U + 9 * 4);
  EXPECT_EQ(segments_, 1U);
  EXPECT_EQ(sdo("50 1810 02 00000000").substr(18), "00 00 01 06");
  EXPECT_EQ(sdo("50 0010 00 00000000").substr(18), "00 00 01 06");
  EXPECT_EQ(download({0x6099, 1}, hex("10270000 E8030000"), 0x31), 0U);
  EXPECT_EQ(slave().model().values().number({0x6099, 2}), 1000U);
  EXPECT_EQ(download({0x1600, 0}, hex("0000 10004060"), 0x31), 0U);
  EXPECT_EQ(slave().model().values().number({0x1600, 1}), 0x6040'0010U);
  EXPECT_EQ(download({0x6099, 1}, hex("10270000 E80300"), 0x31), 0x0607'0013U);
  EXPECT_EQ(download({0x6099, 1}, Bytes(9, 0), 0x31), 0x0607'0012U);
}

TEST_F(EscSdo, AnObjectOfTheOutputsCanBeBarredInOp) {
  start(256);
  for (const auto* request : {"2B 121C 01 0217 0000", "2F 121C 00 01000000"})
    EXPECT_EQ(sdo(request).substr(6, 2), "60");
  EXPECT_EQ(write(0x0810, "0018 1300 64 00 01 00"), 1);
  EXPECT_EQ(request(4), "04 00 00 00 00 00");
  slave().faults().refuses_mapped_writes = true;
  EXPECT_EQ(sdo("23 FF60 00 10270000").substr(6, 2), "60");
  EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  EXPECT_EQ(request(8), "08 00 00 00 00 00");
  EXPECT_EQ(sdo("23 FF60 00 10270000"), "00 20 80 FF 60 00 06 00 01 06");
  EXPECT_EQ(sdo("23 8160 00 10270000").substr(6, 2), "60");
}

}  // namespace
}  // namespace servoctl::sim
