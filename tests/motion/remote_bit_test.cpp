// Bit 9 (remote) of the statusword: why it may be 0, and what can be done.
#include <gtest/gtest.h>

#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

/// A drive that sets bit 9 in the NMT state operational only, or never.
class RemoteBit : public testing::Test {
 protected:
  void SetUp() override {
    bench.bus->alter = [this](can::Frame& frame) {
      const bool is_statusword = frame.id == 0x581 && frame.data[1] == 0x41 && frame.data[2] == 0x60;
      if (is_statusword && !started) frame.data[5] = static_cast<std::uint8_t>(frame.data[5] & ~0x02U);
    };
    bench.bus->on_sent = [this](const can::Frame& frame) {
      if (frame.id == 0 && frame.data[0] == 1) started = starts;
    };
  }
  std::vector<PreflightItem> look() {
    Motion motion(*bench.session, bench.profile(), 1, bench.options);
    EXPECT_TRUE(motion.prepare());
    auto items = motion.look_at_drive(false);
    return items ? *items : std::vector<PreflightItem>();
  }
  static const PreflightItem* remote(const std::vector<PreflightItem>& items) {
    for (const auto& item : items)
      if (item.what == "remote") return &item;
    return nullptr;
  }

  MotionBench bench{"gsd600", 131072};
  bool started = false;
  bool starts = true;
};

TEST_F(RemoteBit, NamesTheStateOperationalWhereTheNodeIsInAnother) {
  const auto items = look();
  const auto* item = remote(items);
  ASSERT_NE(item, nullptr);
  EXPECT_EQ(item->weight, PreflightItem::Weight::stop);
  EXPECT_NE(item->text.find("its panel, its own software or an input controls it"), std::string::npos)
      << item->text;
  const auto refused = check_preflight(items, 1);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().hint.text().find("`nmt start -n 1`"), std::string::npos)
      << refused.error().hint.text();
  EXPECT_NE(refused.error().hint.text().find("--ignore-remote"), std::string::npos)
      << refused.error().hint.text();
}

TEST_F(RemoteBit, IsSetOnceTheNodeIsStarted) {
  ASSERT_TRUE(bench.session->network().request_state(1, session::NodeState::operational));
  EXPECT_EQ(remote(look()), nullptr);
}

TEST_F(RemoteBit, DoesNotNameTheStateOfANodeThatIsOperational) {
  starts = false;
  ASSERT_TRUE(bench.session->network().request_state(1, session::NodeState::operational));
  bench.bus->injected.push_back("701#05");
  ASSERT_TRUE(bench.session->listen());
  const auto items = look();
  ASSERT_NE(remote(items), nullptr);
  EXPECT_EQ(remote(items)->text.find("nmt start"), std::string::npos) << remote(items)->text;
}

TEST_F(RemoteBit, ThatIsIgnoredIsACaution) {
  bench.options.ignores_remote = true;
  const auto items = look();
  ASSERT_NE(remote(items), nullptr);
  EXPECT_EQ(remote(items)->weight, PreflightItem::Weight::caution);
  EXPECT_TRUE(check_preflight(items, 1));
}

TEST(RemoteBitOfAFamily, MayMeanNothing) {
  const auto rules =
      drive::parse_rules("format = 1\nfamily = \"mine\"\n[statusword]\nremote_bit = false\n", "mine.toml");
  ASSERT_TRUE(rules) << rules.error().message.text();
  drive::Profile profile;
  profile.rules = *rules;
  MotionBench bench("gsd600", 131072);
  EXPECT_FALSE(Power(*bench.session, profile, 1).tells(kRemote));
  profile.rules.remote_bit = true;
  EXPECT_TRUE(Power(*bench.session, profile, 1).tells(kRemote));
}

}  // namespace
}  // namespace servoctl::motion
