// Drives that lie, refuse, ignore, fall silent, lose their enable input or their link at any moment of a
// motion: the end never claims what was not seen. LYING_DRIVES=COUNT and LYING_SEED=SEED make it an attack
// (tests/attack).
#include <fmt/format.h>
#include <cstdlib>
#include <random>

#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

struct LyingFamily {
  const char* name;
  double turn;
};
constexpr LyingFamily kLyingFamilies[] = {
    {"gsd600", 131072}, {"da200", 10000}, {"ts", 10000}, {"sv2", 131072}, {"dm", 0}};

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

/// One motion with one or two things that go wrong, by a seed.
class LyingDrive {
 public:
  explicit LyingDrive(unsigned seed)
      : random_(seed), family_(kLyingFamilies[pick(5)]), bench_(family_.name, family_.turn) {}

  /// What is not as it was told; empty when nothing is.
  std::string run() {
    const int at = 1 + pick(40);
    const int count = 1 + pick(2);
    for (int i = 0; i < count; ++i) lies_.push_back(pick(11));
    int samples = 0;
    bench_.options.on_sample = [&](const MotionSample&) {
      if (++samples == at) go_wrong();
    };
    const auto done =
        pick(2) == 0 ? bench_.jog(jog_for("60rpm", 400ms)) : bench_.move(move_to("90deg", "60rpm", true));
    return judge(done);
  }

  std::string what() const {
    std::string out = family_.name;
    for (const int lie : lies_) out += fmt::format(" lie {}", lie);
    return out;
  }

 private:
  int pick(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

  void go_wrong() {
    for (const int lie : lies_) tell_lie(lie);
  }

  void tell_lie(int lie) {
    auto& drive = bench_.drive();
    auto& wrong = drive.misbehaviour();
    const auto now = bench_.session->now();
    switch (lie) {
      case 0: wrong.ignores_disable = true; return;
      case 1: wrong.stays_switched_on = true; return;
      case 2: wrong.feigned.insert(pick(2) == 0 ? 0x6040 : 0x6060); return;
      case 3: wrong.refused.insert(pick(2) == 0 ? 0x6040 : 0x60FF); return;
      case 4: drive.wire_faults().silent = true; return;
      case 5: drive.wire_faults().drop_answers = static_cast<std::uint32_t>(1 + pick(6)); return;
      case 6: drive.wire_faults().duplicate_answers = static_cast<std::uint32_t>(1 + pick(20)); return;
      case 7: drive.set_torque_off(true); return;
      case 8:
        bench_.bus->outage.from = now + std::chrono::milliseconds(pick(300));
        bench_.bus->outage.to = bench_.bus->outage.from + std::chrono::milliseconds(5 + pick(12'000));
        return;
      case 9: (void)bench_.bus->bus.send(canopen::nmt_frame(canopen::NmtCommand::stop, 1)); return;
      case 10: drive.raise_fault(0x2310, {}, now); return;
      default: return;
    }
  }

  std::string judge(const MotionReport& done) {
    const auto state = bench_.drive().power_state();
    const bool has_power = drive::is_energised(state) || state == DriveState::switched_on;
    if (done.end.verified && has_power) return fmt::format("verified, and it is in {}", drive::name(state));
    const bool all_well = done.outcome && done.end.verified && done.end.left.empty();
    if (all_well && !bench_.changed().empty() && done.end.notes.empty())
      return "nothing is left behind, and this is: " + bench_.changed().front();
    if (!done.begun || !done.end.left.empty() || !done.end.verified) return {};
    // What was told to be over stays so.
    bench_.drive().set_torque_off(false);
    bench_.wait(100ms);
    return bench_.energised() ? "verified, and it has started again by itself" : "";
  }

  std::mt19937 random_;
  LyingFamily family_;
  MotionBench bench_;
  std::vector<int> lies_;
};

TEST(LyingDrives, AreNeverToldToBeAtRestWhenTheyAreNot) {
  const int count = from_environment("LYING_DRIVES", 60);
  const auto seed = static_cast<unsigned>(from_environment("LYING_SEED", 1));
  for (int i = 0; i < count; ++i) {
    const auto own = seed * 100'003U + static_cast<unsigned>(i);
    LyingDrive drive(own);
    const auto wrong = drive.run();
    EXPECT_EQ(wrong, "") << "LYING_DRIVES=" << i + 1 << " LYING_SEED=" << seed << ": " << drive.what();
  }
}

}  // namespace
}  // namespace servoctl::motion
