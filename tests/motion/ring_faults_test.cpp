// Rings of one to five slaves in virtual time, every fault of the simulated slave at each place of each: what
// is read and written is so, or an error names the slave; no other slave answers; no motor is left with
// power.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "drive/standard_objects.hpp"
#include "motion/motion_kinds.hpp"
#include "tests/session/ethercat_world.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kMostSlaves = 5;
constexpr ObjectAddress kOwn{0x6083, 0};  ///< Each slave holds another value here.

/// Whose objects are reached, and whose motors turn, all the same.
enum class Reach : std::uint8_t {
  all,
  before,    ///< The slaves in front of its place.
  but_it,    ///< All others.
  whatever,  ///< Nothing is said of it but that what is told is so.
};

class RingTrouble : public session::EtherCatTest {
 public:
  std::string spec(std::uint8_t size) const {
    std::string out;
    for (unsigned node = 1; node <= size; ++node) out += fmt::format("{}sv2@{}", node > 1 ? "," : "", node);
    return out;
  }
  sim::EscSlave& at(std::uint8_t node) { return slave(node - 1U); }
  sim::EscRing& wire() { return ring(); }
  void fall(std::uint8_t node) { at(node).plan_fall({session_->now(), sim::EscState::safe_op, 0x001A}); }
};

struct RingFault {
  const char* name;
  std::string options = {};  ///< Of the ring.
  std::function<void(RingTrouble&, std::uint8_t)> before = {};
  std::function<void(RingTrouble&, std::uint8_t)> while_moving = {};
  Reach objects = Reach::all;
  Reach motors = Reach::all;
  std::string told = {};  ///< By an error, a notice or an event.
  bool cuts_supply = false;
  bool one_place = false;  ///< It is the wire's: its place means nothing.
};

std::vector<RingFault> ring_faults() {
  using Ring = RingTrouble;
  const auto cut = [](Ring& ring, std::uint8_t node) { ring.wire().cut_cable(node - 1U); };
  const auto power = [](Ring& ring, std::uint8_t node) { ring.wire().power_off(node - 1U); };
  const auto silent = [](Ring& ring, std::uint8_t) { ring.wire().cut_cable(0); };
  return {
      {.name = "none"},
      {.name = "lose", .options = "?lose=20", .one_place = true},
      {.name = "short", .options = "?short=20", .one_place = true},
      {.name = "loseManyAndShort",
       .options = "?lose=5&short=7",
       .objects = Reach::whatever,
       .motors = Reach::whatever,
       .one_place = true},
      {.name = "cut", .before = cut, .objects = Reach::before, .motors = Reach::before},
      {.name = "cutWhileMoving", .while_moving = cut, .motors = Reach::before},
      {.name = "power",
       .before = power,
       .objects = Reach::before,
       .motors = Reach::before,
       .cuts_supply = true},
      {.name = "powerWhileMoving", .while_moving = power, .motors = Reach::before, .cuts_supply = true},
      {.name = "silentWhileMoving", .while_moving = silent, .motors = Reach::whatever, .one_place = true},
      {.name = "fallWhileMoving",
       .while_moving = [](Ring& ring, std::uint8_t node) { ring.fall(node); },
       .motors = Reach::but_it},
      {.name = "freeRun",
       .before = [](Ring& ring, std::uint8_t node) { ring.at(node).faults().refuses_free_run = true; },
       .told = "SYNC0"},
      {.name = "mailbox",
       .before = [](Ring& ring, std::uint8_t node) { ring.at(node).faults().mailbox_stays_full = true; },
       .objects = Reach::but_it,
       .motors = Reach::but_it,
       .told = "its mailbox stays full"},
      {.name = "emergency",
       .before = [](Ring& ring, std::uint8_t node) { ring.at(node).faults().emergencies = 3; },
       .told = "emergency"},
      {.name = "siiBlank",
       .before = [](Ring& ring,
                    std::uint8_t node) { ring.at(node).registers().sii().set_content(Bytes(128, 0xFF)); },
       .told = "the mailbox of its family is used"},
      {.name = "siiMute",
       .before = [](Ring& ring, std::uint8_t node) { ring.at(node).registers().sii().mute = true; },
       .told = "the mailbox of its family is used"},
      {.name = "delay",
       .before = [](Ring& ring, std::uint8_t node) { ring.at(node).faults().answer_delay = 20ms; }},
  };
}

class RingFaults : public RingTrouble, public testing::WithParamInterface<RingFault> {
 protected:
  bool must(Reach reach, std::uint8_t node) const {
    return reach == Reach::all || (reach == Reach::before && node < place_) ||
           (reach == Reach::but_it && node != place_);
  }
  bool must_not(Reach reach, std::uint8_t node) const {
    return (reach == Reach::before && node >= place_) || (reach == Reach::but_it && node == place_);
  }
  static std::uint32_t own(std::uint8_t node) { return 1000U + node; }
  static std::uint32_t written(std::uint8_t node) { return 5000U + node; }

  void build(std::uint8_t size, std::uint8_t place) {
    said_.clear();
    size_ = size;
    place_ = place;
    open(spec(size) + GetParam().options);
    for (std::uint8_t node = 1; node <= size; ++node) {
      network().learn(node, rules());
      ASSERT_EQ(at(node).model().write(kOwn, store_le(own(node), 4)), 0U);
    }
    if (GetParam().before) GetParam().before(*this, place);
  }
  /// An error is about the node that was asked, or about all.
  template <class T>
  bool is_fine(const Result<T>& result, std::uint8_t node) {
    if (result) return true;
    said_ += result.error().message.text() + "\n";
    EXPECT_TRUE(result.error().node == node || result.error().code == Errc::bus)
        << result.error().message.text();
    return false;
  }
  void hear() {
    for (const auto& notice : network().take_notices()) said_ += notice.text() + "\n";
    for (const auto& event : session_->take_events())
      if (std::holds_alternative<canopen::Emergency>(event.what)) said_ += "emergency\n";
  }

  void read_and_write(std::uint8_t node) {
    const auto read = session_->upload(node, kOwn);
    const bool was_read = is_fine(read, node);
    if (was_read) {
      EXPECT_EQ(load_le(*read), own(node));
    }
    const bool was_written = is_fine(session_->download(node, kOwn, store_le(written(node), 4)), node);
    if (was_written) {
      EXPECT_EQ(at(node).model().values().number(kOwn), written(node));
    }
    if (must(GetParam().objects, node)) {
      EXPECT_TRUE(was_read && was_written) << said_;
    }
    if (must_not(GetParam().objects, node)) {
      EXPECT_FALSE(was_read || was_written);
    }
  }
  /// What a motion in profile velocity does, without its preflight.
  bool start(MotionGuard& guard, std::uint8_t node) {
    return is_fine(guard.start_node(), node) && is_fine(guard.neutral_targets(), node) &&
           is_fine(guard.change_mode(3), node) && is_fine(guard.enable(), node) &&
           is_fine(guard.change(objects::kTargetVelocity, store_le(5000U, 4)), node);
  }
  void move(std::uint8_t node) {
    const MotionUnits units(*session_, *port_->cell().profiles.front(), node, {});
    MotionGuard guard(*session_, units, node);
    if (!start(guard, node)) {
      EXPECT_FALSE(must(GetParam().motors, node) || GetParam().while_moving) << int{node} << ": " << said_;
      return;
    }
    pass(20ms);
    if (GetParam().while_moving) GetParam().while_moving(*this, place_);
    (void)session_->wait([] { return false; }, session_->now() + 40ms);
    if (must(GetParam().motors, node)) {
      EXPECT_TRUE(at(node).model().is_moving()) << said_;
      EXPECT_TRUE(guard.end().verified) << said_;
      EXPECT_EQ(at(node).state(), sim::EscState::pre_op);
    }
    const auto end = guard.end();
    if (end.verified) {
      expect_without_power(node);
    }
  }
  void expect_without_power(std::uint8_t node) {
    EXPECT_FALSE(drive::is_energised(at(node).model().power_state())) << int{node};
    EXPECT_FALSE(at(node).model().is_moving()) << int{node};
  }
  /// Whatever became of the wire: the program has ended, and the watchdogs have had their time.
  void expect_all_is_over() {
    (void)session_->close();
    session_.reset();
    for (const auto end = port_->now() + 300ms; port_->now() < end;)
      if (!port_->receive(end)) break;
    for (std::uint8_t node = 1; node <= size_; ++node) {
      const auto holds = at(node).model().values().number(kOwn);
      EXPECT_TRUE(holds == own(node) || holds == written(node)) << int{node} << " holds " << holds;
      // One without supply is looked at when it has it again.
      if (GetParam().cuts_supply && node == place_) ring().power_on(node - 1U, port_->now());
      expect_without_power(node);
      EXPECT_NE(at(node).state(), sim::EscState::op) << int{node};
    }
  }

  std::uint8_t size_ = 0;
  std::uint8_t place_ = 0;
  std::string said_;
};

TEST_P(RingFaults, AreToldWhereTheyAreAndLeaveNoMotorWithPower) {
  for (std::uint8_t size = 1; size <= kMostSlaves; ++size)
    for (std::uint8_t place = 1; place <= size; ++place) {
      if (GetParam().one_place && place > 1) continue;
      SCOPED_TRACE(fmt::format("place {} of {}", place, size));
      build(size, place);
      for (std::uint8_t node = 1; node <= size; ++node) read_and_write(node);
      move(place);
      if (size > 1 && !GetParam().while_moving) move(static_cast<std::uint8_t>(place == 1 ? 2 : place - 1));
      hear();
      EXPECT_NE(said_.find(GetParam().told), std::string::npos) << said_;
      expect_all_is_over();
      if (HasFailure()) return;
    }
}

INSTANTIATE_TEST_SUITE_P(Every, RingFaults, testing::ValuesIn(ring_faults()),
                         [](const testing::TestParamInfo<RingFault>& fault) { return fault.param.name; });

}  // namespace
}  // namespace servoctl::motion
