#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "drive/standard_objects.hpp"
#include "motion_support.hpp"
#include "tests/session/ethercat_world.hpp"

namespace servoctl::motion {

using namespace std::chrono_literals;

/// One drive on a ring, in virtual time.
class EtherCatMotion : public session::EtherCatTest {
 protected:
  void SetUp() override {
    open("sv2@1");
    network().learn(1, rules());
  }
  const drive::Profile& profile() { return *port_->cell().profiles.front(); }

  template <class Kind>
  MotionReport run(const Kind& kind, Result<MotionPlan> (*plan)(Motion&, const Kind&),
                   MotionReport (*go)(Motion&, const Kind&, const MotionPlan&)) {
    MotionReport out;
    Motion motion(*session_, profile(), 1, options_);
    const auto ready = motion.prepare();
    EXPECT_TRUE(ready) << ready.error().message.text();
    const auto made = plan(motion, kind);
    EXPECT_TRUE(made) << made.error().message.text();
    before_ = objects();
    return go(motion, kind, *made);
  }
  MotionReport jog(std::string speed = "60rpm", Duration length = 1s) {
    return run(jog_for(std::move(speed), length), plan_jog, run_jog);
  }

  /// Every value a master can set, but the controlword, and 607Ah, which holds where the axis stood when OP
  /// began.
  std::map<std::string, Bytes> objects() {
    std::map<std::string, Bytes> out;
    for (const auto& object : profile().dictionary.objects())
      for (const auto& entry : object.entries) {
        Bytes value;
        if (entry.access == od::Access::rw && entry.address.index != 0x6040 &&
            entry.address.index != 0x607A && slave().model().read(entry.address, value) == 0)
          out[to_string(entry.address)] = value;
      }
    return out;
  }
  std::vector<std::string> changed() {
    std::vector<std::string> out;
    for (const auto& [name, bytes] : objects())
      if (bytes != before_[name]) out.push_back(name + " is " + to_hex(bytes));
    return out;
  }
  void expect_left_alone(const MotionReport& done) {
    EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
    EXPECT_TRUE(done.end.verified);
    EXPECT_EQ(done.end.notes, std::vector<std::string>{});
    EXPECT_EQ(done.end.left, std::vector<std::string>{});
    expect_safe();
    EXPECT_EQ(slave().state(), sim::EscState::pre_op);
    EXPECT_EQ(slave().al_code(), 0);
    EXPECT_EQ(changed(), std::vector<std::string>{});
  }
  void expect_safe() {
    EXPECT_FALSE(drive::is_energised(slave().model().power_state()));
    EXPECT_FALSE(slave().model().is_moving());
  }
  /// The wire is not there from that time of the motion on.
  void cut_after(Duration time) {
    options_.on_sample = [this, time,
                          begin = std::optional<TimePoint>()](const MotionSample& sample) mutable {
      if (!begin) begin = sample.time;
      if (sample.time - *begin >= time) ring().cut_cable(0);
    };
  }

  MotionOptions options_;
  std::map<std::string, Bytes> before_;
};

}  // namespace servoctl::motion
