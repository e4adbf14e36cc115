#include "ethercat/sii_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ethercat/registers.hpp"
#include "ethercat/sii_image.hpp"
#include "sii_images.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

/// Registers 0500h to 050Fh of a slave with this memory.
struct Memory {
  explicit Memory(Bytes content) : image(std::move(content)) {}
  Bytes image;
  bool eight = false;
  bool theirs = false;  ///< The slave's processor has it.
  int held = 0;         ///< So often it is at it when asked.
  int busy = 0;         ///< So many polls a command takes.
  bool stuck = false;   ///< Busy for ever.
  int errors = 0;       ///< So many commands fail.
  std::uint16_t counter = 1;
  bool lost = false;
  std::array<std::uint8_t, 16> registers{};
  int left = 0;
  std::vector<Request> seen;
  Bytes reply;

  Answer answer(const Request& request) {
    seen.push_back(request);
    const std::size_t at = (request.address >> 16U) - reg::kSiiAccess;
    if (request.command == Command::fpwr) {
      std::copy(request.data.begin(), request.data.end(),
                registers.begin() + static_cast<std::ptrdiff_t>(at));
      if (at == 0) theirs = (request.data[0] & 1U) != 0;
      if (at == 2 && request.data[1] == 1) command();
      if (at == 2 && request.data[1] == 0) status(0);
      return {{}, counter, lost, {}};
    }
    if (at == 0) registers[0] = theirs ? 1 : 0;
    if (at == 0) registers[1] = held-- > 0 ? 1 : 0;
    if (at == 2 && left > 0) --left;
    if (at == 2)
      registers[3] = static_cast<std::uint8_t>((registers[3] & 0x7FU) | (left > 0 || stuck ? 0x80U : 0U));
    reply.assign(registers.begin() + static_cast<std::ptrdiff_t>(at),
                 registers.begin() + static_cast<std::ptrdiff_t>(at + request.data.size()));
    return {reply, counter, lost, {}};
  }
  void status(std::uint16_t bits) {
    bits = static_cast<std::uint16_t>(bits | (eight ? reg::kSiiEightBytes : 0));
    registers[2] = static_cast<std::uint8_t>(bits);
    registers[3] = static_cast<std::uint8_t>(bits >> 8U);
  }
  void command() {
    left = busy;
    if (errors-- > 0) return status(reg::kSiiCommandError);
    status(0);
    const auto at = 2 * load_le(ByteSpan(registers).subspan(4, 4));
    for (std::size_t i = 0; i < (eight ? 8U : 4U); ++i)
      registers[8 + i] = at + i < image.size() ? image[at + i] : std::uint8_t{0xFF};
  }
};

class SiiReaderTest : public testing::Test {
 protected:
  Result<Bytes> read() {
    reader.start(now);
    return run();
  }
  Result<Bytes> run() {
    for (int steps = 0; steps < 100'000; ++steps) {
      if (auto result = reader.take_result()) {
        EXPECT_EQ(reader.deadline(), kNever);
        EXPECT_FALSE(reader.busy());
        EXPECT_FALSE(reader.take_request());
        return *result;
      }
      if (const auto request = reader.take_request()) {
        now += 50us;
        reader.on_answer(memory.answer(*request), now);
        continue;
      }
      EXPECT_NE(reader.deadline(), kNever) << "it waits for nothing";
      now = std::max(now, reader.deadline());
      reader.on_time(now);
    }
    return fail(Errc::bug, "no end");
  }
  void expect_failure(Errc code, std::string_view message) {
    const auto result = read();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, code);
    EXPECT_EQ(result.error().message.text(), message);
    EXPECT_NE(result.error().hint.text(), "");
    EXPECT_EQ(result.error().node, 3);
  }

  Memory memory{full_sii()};
  SiiReader reader{3, SlaveAddress::station(0x1003)};
  TimePoint now{1s};
};

TEST_F(SiiReaderTest, AWordIsReadAsAnotherMasterReadsIt) {
  // Command and answer as in frames 512 to 515 of dumps/twincat-scan-boxes.pcapng of ethercrab: 14 bytes from
  // 0502h on.
  reader.start_head(4, now);
  EXPECT_EQ(reader.take_request()->address, 0x0500'1003U);
  EXPECT_FALSE(reader.take_request());
  reader.on_answer({hex("0000"), 1, false, {}}, now);
  EXPECT_EQ(reader.take_request()->data.size(), 2U);
  reader.on_answer({hex("4000"), 1, false, {}}, now);
  const auto command = reader.take_request();
  EXPECT_EQ(command->command, Command::fpwr);
  EXPECT_EQ(command->address, 0x0502'1003U);
  EXPECT_EQ(to_hex(command->data), "00 01 00 00 00 00");
  reader.on_answer({{}, 1, false, {}}, now);
  EXPECT_EQ(reader.take_request()->data.size(), 14U);
  reader.on_answer({hex("40000000000002000000522c4c04"), 1, false, {}}, now);
  EXPECT_EQ(to_hex(**reader.take_result()), "02 00 00 00 52 2C 4C 04");
}

TEST_F(SiiReaderTest, TheWholeImageIsReadAsFarAsItsCategoriesGo) {
  const auto image = read();
  ASSERT_TRUE(image);
  EXPECT_EQ(*image, full_sii());
  EXPECT_TRUE(parse_sii(*image).doubts.empty());
  const auto with_four = memory.seen.size();
  memory.eight = true;
  memory.seen.clear();
  EXPECT_EQ(read().value(), full_sii());
  EXPECT_LT(memory.seen.size(), with_four * 6 / 10) << "eight bytes at a time";
}

TEST_F(SiiReaderTest, ItsHeadAloneIsReadWithoutTheRest) {
  reader.start_head(kSiiHeader, now);
  const auto head = run();
  ASSERT_TRUE(head);
  EXPECT_EQ(head->size(), 128U);
  EXPECT_EQ(parse_sii(*head).product, 0x0041'4B44U);
}

TEST_F(SiiReaderTest, AMemoryThatIsBusyIsWaitedFor) {
  memory.busy = 4;
  EXPECT_EQ(read().value(), full_sii());
}

TEST_F(SiiReaderTest, AMemoryThatStaysBusyEndsTheRead) {
  memory.stuck = true;
  const auto begin = now;
  expect_failure(Errc::timeout, "node 3: its SII cannot be read: the memory stays busy");
  EXPECT_GE(now - begin, 100ms);
  EXPECT_LT(now - begin, 120ms);
}

TEST_F(SiiReaderTest, AFailedCommandIsAcknowledgedAndTriedAgain) {
  memory.errors = 2;
  EXPECT_EQ(read().value(), full_sii());
  memory.errors = 1000;
  expect_failure(Errc::protocol, "node 3: its SII cannot be read: the memory reports an error at word 00h");
}

TEST_F(SiiReaderTest, TheSlavesProcessorIsAskedForTheMemoryAndGetsItBack) {
  memory.theirs = true;
  memory.held = 3;
  EXPECT_EQ(read().value(), full_sii());
  EXPECT_TRUE(memory.theirs);
  EXPECT_EQ(memory.seen.back().address, 0x0500'1003U);
  EXPECT_EQ(to_hex(memory.seen.back().data), "01");
}

TEST_F(SiiReaderTest, TheMemoryIsGivenBackAfterAFailureToo) {
  memory.theirs = true;
  memory.errors = 1000;
  expect_failure(Errc::protocol, "node 3: its SII cannot be read: the memory reports an error at word 00h");
  EXPECT_TRUE(memory.theirs);
}

TEST_F(SiiReaderTest, AProcessorThatDoesNotLetGoIsNotForced) {
  memory.theirs = true;
  memory.held = 1'000'000;
  expect_failure(Errc::timeout, "node 3: its SII cannot be read: its own processor does not release the SII");
  for (const auto& request : memory.seen) EXPECT_EQ(request.command, Command::fprd) << "nothing was written";
}

TEST_F(SiiReaderTest, ASlaveThatIsGoneIsTold) {
  memory.counter = 0;
  expect_failure(Errc::timeout, "node 3: its SII cannot be read: it does not answer");
  memory.lost = true;
  expect_failure(Errc::timeout, "node 3: its SII cannot be read: frames do not come back");
}

TEST_F(SiiReaderTest, AnEmptyMemoryEndsTheReadAtOnce) {
  memory.image.assign(0x10000, 0);
  EXPECT_EQ(read().value().size(), 132U);
  memory.image.assign(0x10000, 0xFF);
  EXPECT_EQ(read().value().size(), 132U);
}

TEST_F(SiiReaderTest, ACategoryThatLeadsOutOfTheMemoryEndsWithIt) {
  memory.image[0x7C] = 1;  // 2 Kibit: 256 bytes.
  memory.image.resize(256);
  EXPECT_EQ(read().value(), memory.image);
}

TEST_F(SiiReaderTest, AnAnswerForAnotherAddressIsNotTaken) {
  reader.start_head(2, now);
  for (const auto* reply :
       {"0000", "0000", "", "00000C0000000200000000000000", "0000", "", "0000000000000500000000000000"}) {
    ASSERT_TRUE(reader.take_request());
    const auto bytes = hex(reply);
    reader.on_answer({bytes, 1, false, {}}, now);
  }
  EXPECT_EQ(to_hex(**reader.take_result()), "05 00 00 00");
}

}  // namespace
}  // namespace servoctl::ethercat
