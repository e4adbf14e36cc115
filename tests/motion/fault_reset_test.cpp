// A fault reset that goes wrong leaves the drive without power and listening.
#include "motion/fault_reset.hpp"
#include "session/can_network.hpp"

#include <gtest/gtest.h>

#include "tests/session/scripted_bus.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

/// A drive in fault that may be reset over the bus.
class FaultyDrive {
 public:
  FaultyDrive() : drive_(profile(), 1, memory_, "1") {
    bus_.attach(drive_);
    session::Session session(quiet(), "sim", {});
    (void)session.wait([] { return false; }, session.now() + 1s);
    EXPECT_TRUE(session.download(1, {0x2000, 0x21}, {1, 0}));  // Pn0032, in force after a restart.
    EXPECT_TRUE(session.can()->send(*can::parse_frame("000#8101")));
    (void)session.wait([] { return false; }, session.now() + 1s);
    drive_.raise_fault(0x3210, {}, bus_.now());
    (void)session.wait([] { return false; }, session.now() + 1s);
  }

  Result<FaultReset> reset(const session::Trouble& trouble) {
    auto troubled = std::make_unique<session::TroubledBus>(bus_, drive_, trouble, 1);
    const auto* counted = troubled.get();
    session::Session session(std::move(troubled), "sim", {});
    session.options().cancelled = [&] {
      return trouble.cancel_at >= 0 && counted->frames() > trouble.cancel_at;
    };
    auto out = reset_fault(session, &profile(), 1);
    frames = counted->frames();
    for (const auto& frame : counted->sent())
      if (frame.find("#2B406000") != std::string::npos) last_controlword = frame.substr(frame.size() - 8, 4);
    return out;
  }

  int frames = 0;
  std::string last_controlword;  ///< The bytes as they were sent.

 private:
  static const drive::Profile& profile() {
    static const std::filesystem::path kFolders[] = {std::filesystem::path(source_dir()) / "eds"};
    static const auto kProfile = drive::load_profile("gsd600", kFolders).value();
    return kProfile;
  }
  std::unique_ptr<can::Bus> quiet() {
    return std::make_unique<session::TroubledBus>(bus_, drive_, session::Trouble{}, 1);
  }

  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
};

TEST(FaultReset, TakesTheEdgeBackWhateverGoesWrong) {
  FaultyDrive measure;
  const auto well = measure.reset({});
  ASSERT_TRUE(well) << well.error().message.text();
  EXPECT_EQ(*well, FaultReset::done);
  EXPECT_EQ(measure.last_controlword, "0000");
  for (auto session::Trouble::*kind : {&session::Trouble::cancel_at, &session::Trouble::abort_at})
    for (int step = 0; step < measure.frames - 1; ++step) {
      SCOPED_TRACE(step);
      FaultyDrive drive;
      session::Trouble trouble;
      trouble.*kind = step;
      (void)drive.reset(trouble);
      EXPECT_NE(drive.last_controlword, "8000") << "the edge was left standing";
    }
}

/// Answers every statusword question with the next of these, every write with an acknowledge.
std::unique_ptr<session::ScriptedBus> drive_that_says(std::deque<std::string> statuswords) {
  auto bus = std::make_unique<session::ScriptedBus>();
  bus->on_send = [statuswords](session::ScriptedBus& self, const std::string& sent) mutable {
    if (sent.find("#40416000") == std::string::npos) return self.arrive("581#6040600000000000");
    self.arrive("581#4B416000" + statuswords.front() + "0000");
    if (statuswords.size() > 1) statuswords.pop_front();
  };
  return bus;
}

TEST(FaultReset, SaysSoWhenTheDriveIsEnergisedAfterIt) {
  session::Session session(drive_that_says({"1802", "3702"}), "sim", {});
  const auto done = reset_fault(session, nullptr, 1);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::negative);
  EXPECT_NE(done.error().message.text().find("it is energised"), std::string::npos)
      << done.error().message.text();
}

TEST(FaultReset, WritesNothingToADriveWithoutFault) {
  auto bus = drive_that_says({"5002"});
  const auto* heard = bus.get();
  session::Session session(std::move(bus), "sim", {});
  EXPECT_EQ(reset_fault(session, nullptr, 1), FaultReset::no_fault);
  EXPECT_EQ(heard->sent.size(), 1U);
}

}  // namespace
}  // namespace servoctl::motion
