// Traces of Ethernet frames, byte for byte as the drafts of the formats have them, and what becomes of them
// when they cannot be written.
#include "ethernet/pcap_trace.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <deque>
#include <filesystem>
#include <string>

#include "base/file.hpp"
#include "frames.hpp"

namespace servoctl::ethernet {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A wire in virtual time, which gives what the test put in.
class ScriptedPort final : public Port {
 public:
  TimePoint now() const override { return now_; }
  Result<void> send(ByteSpan) override {
    if (broken) return fail(Errc::bus, "eth0 went down");
    return {};
  }
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override {
    if (broken) return fail(Errc::bus, "eth0 went down");
    if (coming.empty() || coming.front().first > deadline) {
      now_ = std::max(now_, deadline);
      return std::optional<ByteSpan>();
    }
    now_ = std::max(now_, coming.front().first);
    given_ = coming.front().second;
    coming.pop_front();
    return std::optional(ByteSpan(given_));
  }
  Result<void> recover(TimePoint) override { return {}; }

  std::deque<std::pair<TimePoint, Bytes>> coming;
  bool broken = false;

 private:
  TimePoint now_{milliseconds(1736412345123)};
  Bytes given_;
};

class PcapTest : public testing::Test {
 protected:
  PcapTest() {
    std::string name = testing::TempDir() + "servoctl-pcap-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~PcapTest() override { std::filesystem::remove_all(folder_); }

  void open(const std::string& name) {
    auto inner = std::make_unique<ScriptedPort>();
    inner_ = inner.get();
    file_ = folder_ / name;
    auto port = pcap_to(std::move(inner), file_, "eth0", can::TraceClock::bus,
                        [this](const Error& error) { failures_.push_back(error.message.text()); });
    ASSERT_TRUE(port) << port.error().message.text();
    port_ = std::move(*port);
  }
  std::string written() const {
    const auto text = read_file(file_).value();
    return to_hex(Bytes(text.begin(), text.end()));
  }
  /// A frame of 60 bytes as hex.
  static std::string shown(std::uint8_t number) { return to_hex(frame_of(number)); }

  std::filesystem::path folder_;
  std::filesystem::path file_;
  ScriptedPort* inner_ = nullptr;
  std::unique_ptr<Port> port_;
  std::vector<std::string> failures_;
};

TEST_F(PcapTest, TheClassicFormHasAHeadOf24BytesAndOneOf16InFrontOfEachFrame) {
  open("trace.pcap");
  inner_->coming.emplace_back(inner_->now() + milliseconds(2), frame_of(2));
  ASSERT_TRUE(port_->send(frame_of(1)));
  ASSERT_TRUE(*port_->receive(inner_->now() + seconds(1)));
  port_->end_trace();
  EXPECT_EQ(written(),
            "D4 C3 B2 A1 02 00 04 00 00 00 00 00 00 00 00 00 FF FF 00 00 01 00 00 00 "
            // 1736412345.123000, 60 of 60 bytes
            "B9 8C 7F 67 78 E0 01 00 3C 00 00 00 3C 00 00 00 " +
                shown(1) +
                // 1736412345.125000
                " B9 8C 7F 67 48 E8 01 00 3C 00 00 00 3C 00 00 00 " + shown(2));
}

TEST_F(PcapTest, TheNewerFormTellsInterfaceAndDirection) {
  open("trace.PcapNG");
  inner_->coming.emplace_back(inner_->now(), frame_of(2, 61));
  ASSERT_TRUE(port_->send(frame_of(1)));
  ASSERT_TRUE(*port_->receive(inner_->now() + seconds(1)));
  port_->end_trace();
  const std::string section =
      "0A 0D 0D 0A 1C 00 00 00 4D 3C 2B 1A 01 00 00 00 FF FF FF FF FF FF FF FF 1C 00 00 00 ";
  const std::string interface =
      "01 00 00 00 20 00 00 00 01 00 00 00 FF FF 00 00 02 00 04 00 65 74 68 30 00 00 00 00 20 00 00 00 ";
  // 1736412345123000 us are 00062B40'BA9C98B8h; 60 of 60 bytes, then the flags: outbound.
  const auto time = static_cast<std::uint64_t>(1736412345123000);
  const auto stamp = to_hex(store_le(time >> 32U, 4)) + " " + to_hex(store_le(time & 0xFFFF'FFFFU, 4));
  const auto sent = "06 00 00 00 68 00 00 00 00 00 00 00 " + stamp + " 3C 00 00 00 3C 00 00 00 " + shown(1) +
                    " 02 00 04 00 02 00 00 00 00 00 00 00 68 00 00 00 ";
  const auto received = "06 00 00 00 6C 00 00 00 00 00 00 00 " + stamp + " 3D 00 00 00 3D 00 00 00 " +
                        to_hex(frame_of(2, 61)) + " 00 00 00 02 00 04 00 01 00 00 00 00 00 00 00 6C 00 00 00";
  EXPECT_EQ(written(), section + interface + sent + received);
}

TEST_F(PcapTest, AFrameIsInTheFile100MsLaterAtTheLatest) {
  open("trace.pcap");
  ASSERT_TRUE(port_->send(frame_of(1)));
  EXPECT_EQ(port_->next_event(), inner_->now() + milliseconds(100));
  EXPECT_FALSE(*port_->receive(inner_->now() + milliseconds(99)));
  EXPECT_EQ(std::filesystem::file_size(file_), 0U);
  const auto end = inner_->now() + seconds(1);
  EXPECT_FALSE(*port_->receive(end));
  EXPECT_EQ(inner_->now(), end);
  EXPECT_EQ(std::filesystem::file_size(file_), 24U + 16U + 60U);
}

TEST_F(PcapTest, AWireThatIsLostBringsTheTraceToTheFileAndItsFramesAreNone) {
  open("trace.pcap");
  ASSERT_TRUE(port_->send(frame_of(1)));
  inner_->broken = true;
  EXPECT_FALSE(port_->send(frame_of(2)));
  EXPECT_EQ(std::filesystem::file_size(file_), 24U + 16U + 60U);
}

TEST_F(PcapTest, AFullDiskIsToldOnceAndThePortGoesOn) {
  std::filesystem::create_symlink("/dev/full", folder_ / "full.pcap");
  open("full.pcap");
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(port_->send(frame_of(1)));
    port_->flush_trace();
  }
  ASSERT_EQ(failures_.size(), 1U);
  EXPECT_EQ(failures_.front(), "cannot write the trace " + file_.string() + ": No space left on device");
  port_->end_trace();
  EXPECT_EQ(failures_.size(), 1U);
}

TEST_F(PcapTest, FramesThatAReaderDoesNotTakeAreCountedAndTheHeadIsNone) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.pcap").c_str(), 0600), 0);
  const can::Descriptor reader(::open((folder_ / "pipe.pcap").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  open("pipe.pcap");
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(port_->send(frame_of(1, 1514)));
  const auto notices = port_->take_notices();
  ASSERT_EQ(notices.size(), 1U);
  const auto left_out = std::stoi(notices.front().text());
  EXPECT_GT(left_out, 1000);
  port_->end_trace();
  ASSERT_EQ(failures_.size(), 1U);
  // What the pipe has room for is a head and whole frames, but for the last.
  Bytes taken(std::size_t{1} << 20U);
  const auto size = ::read(reader.get(), taken.data(), taken.size());
  ASSERT_GT(size, 24);
  EXPECT_EQ(std::stoi(failures_.front()), 2000 - (size - 24) / 1530);
}

TEST_F(PcapTest, AFileThatCannotBeMadeIsTold) {
  const auto port =
      pcap_to(std::make_unique<ScriptedPort>(), folder_ / "no" / "trace.pcap", "eth0", can::TraceClock::wall);
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::file);
}

TEST_F(PcapTest, TimesAreThoseOfTheWall) {
  const auto before = std::chrono::system_clock::now().time_since_epoch();
  const auto offset = can::trace_offset(can::TraceClock::wall, TimePoint{seconds(5)});
  EXPECT_GE(offset + seconds(5), std::chrono::duration_cast<Duration>(before));
  EXPECT_LT(offset + seconds(5), before + seconds(60));
  EXPECT_EQ(can::trace_offset(can::TraceClock::bus, TimePoint{seconds(5)}), Duration::zero());
}

}  // namespace
}  // namespace servoctl::ethernet
