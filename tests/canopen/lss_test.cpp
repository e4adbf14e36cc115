// The bytes are those of the figures of CiA 305 as two other stacks, CANopenNode and lely-core, send and read
// them: written down by hand from what their slaves take apart, not from our codec.
#include "canopen/lss.hpp"

#include "canopen/lss_master.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

constexpr LssAddress kSlave{0x00445653, 0x00000001, 0x00020003, 0xDEADBEEF};

class LssMasterTest : public testing::Test {
 protected:
  void ask(const LssRequest& request, std::initializer_list<std::string_view> lines) {
    master.start(request, now);
    play(master, now, lines);
    result = master.take_result();
  }
  LssMaster master{{.patience = 500ms, .further = 100ms, .gap = 1ms}};
  TimePoint now{1s};
  std::optional<LssMaster::Answers> result;
};

TEST_F(LssMasterTest, SwitchesAllAndWaitsForNobody) {
  ask(lss_switch_all(LssState::configuration), {"> 7E5#0401000000000000"});
  EXPECT_TRUE(result && result->empty());
  ask(lss_switch_all(LssState::waiting), {"> 7E5#0400000000000000"});
  EXPECT_TRUE(result && result->empty());
  EXPECT_EQ(master.deadline(), kNever);
}

TEST_F(LssMasterTest, SelectsByFourFramesWithAGapAndHearsTheOneThatIsMeant) {
  ask(lss_select(kSlave),
      {"> 7E5#4053564400000000", "+ 1ms", "> 7E5#4101000000000000", "+ 1ms", "> 7E5#4203000200000000",
       "+ 1ms", "> 7E5#43EFBEADDE000000", "< 7E4#4400000000000000", "+ 99ms", "+ 1ms"});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->size(), 1U);
  EXPECT_EQ(result->front().service, LssService::selected);
}

TEST_F(LssMasterTest, HearsASecondSlaveBehindTheFirst) {
  ask(lss_inquire(LssService::inquire_serial), {"> 7E5#5D00000000000000", "+ 499ms", "< 7E4#5D01000000000000",
                                                "+ 99ms", "< 7E4#5D02000000000000", "+ 100ms"});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->size(), 2U);
  EXPECT_EQ(result->back().number, 2U);
}

TEST_F(LssMasterTest, TellsThatNobodyAnsweredAfterItsPatience) {
  ask(lss_identify_unconfigured(), {"> 7E5#4C00000000000000", "+ 499ms"});
  EXPECT_FALSE(result);
  play(master, now, {"+ 1ms"});
  result = master.take_result();
  EXPECT_TRUE(result && result->empty());
  EXPECT_FALSE(master.busy());
}

TEST_F(LssMasterTest, SetsNodeBitTimingAndStores) {
  ask(lss_set_node(5), {"> 7E5#1105000000000000", "< 7E4#1100000000000000", "+ 100ms"});
  ASSERT_TRUE(result && result->size() == 1U);
  EXPECT_EQ(result->front().error, 0);
  ask(lss_set_bit_timing(2), {"> 7E5#1300020000000000", "< 7E4#1301000000000000", "+ 100ms"});
  ASSERT_TRUE(result && result->size() == 1U);
  EXPECT_EQ(lss_error_text(result->front()), "it does not support this bitrate");
  ask(lss_store(), {"> 7E5#1700000000000000", "< 7E4#17FF070000000000", "+ 100ms"});
  ASSERT_TRUE(result && result->size() == 1U);
  EXPECT_EQ(lss_error_text(result->front()), "an error of its maker's own, 7");
  ask(lss_activate_bit_timing(1000), {"> 7E5#15E8030000000000"});
  EXPECT_TRUE(result && result->empty());
}

TEST_F(LssMasterTest, IdentifiesSlavesInARange) {
  ask(lss_identify({1, 2, 3, 5}, {1, 2, 4, 0xFFFFFFFF}),
      {"> 7E5#4601000000000000", "+ 1ms", "> 7E5#4702000000000000", "+ 1ms", "> 7E5#4803000000000000",
       "+ 1ms", "> 7E5#4904000000000000", "+ 1ms", "> 7E5#4A05000000000000", "+ 1ms",
       "> 7E5#4BFFFFFFFF000000", "< 7E4#4F00000000000000", "+ 100ms"});
  EXPECT_TRUE(result && result->size() == 1U);
}

TEST_F(LssMasterTest, InquiresEachNumberByItsOwnService) {
  ask(lss_inquire(LssService::inquire_vendor),
      {"> 7E5#5A00000000000000", "< 7E4#5A53564400000000", "+ 100ms"});
  ASSERT_TRUE(result && result->size() == 1U);
  EXPECT_EQ(result->front().number, 0x00445653U);
  ask(lss_inquire(LssService::inquire_product), {"> 7E5#5B00000000000000", "+ 500ms"});
  ask(lss_inquire(LssService::inquire_revision), {"> 7E5#5C00000000000000", "+ 500ms"});
  ask(lss_inquire(LssService::inquire_node), {"> 7E5#5E00000000000000", "< 7E4#5EFF000000000000", "+ 100ms"});
  ASSERT_TRUE(result && result->size() == 1U);
  EXPECT_EQ(result->front().number, kUnconfigured);
}

TEST_F(LssMasterTest, TakesNothingElseForAnAnswer) {
  ask(lss_set_node(5),
      {"> 7E5#1105000000000000", "< 7E4#1300000000000000", "< 7E5#1105000000000000", "< 7E4#1100", "< 7E4#R8",
       "< 000007E4#1100000000000000", "< 184#1100000000000000", "+ 494ms"});
  EXPECT_TRUE(result && result->empty());
}

TEST_F(LssMasterTest, EndsThoughSomebodyAnswersForEver) {
  master.start(lss_inquire(LssService::inquire_node), now);
  (void)master.take_frame();
  const auto until = now + 20s;
  while (master.busy() && now < until) {
    now += 10ms;
    master.on_frame(frame("7E4#5E01000000000000"), now);
    master.on_time(now);
  }
  EXPECT_FALSE(master.busy());
  EXPECT_EQ(master.take_result()->size(), LssMaster::kMostAnswers);
}

TEST(Lss, HasTheBitratesOfTable0) {
  const std::pair<std::uint32_t, std::uint8_t> rows[] = {{1'000'000, 0}, {800'000, 1}, {500'000, 2},
                                                         {250'000, 3},   {125'000, 4}, {50'000, 6},
                                                         {20'000, 7},    {10'000, 8}};
  for (const auto& [bitrate, index] : rows) {
    EXPECT_EQ(lss_bit_timing(bitrate), index);
    EXPECT_EQ(lss_bitrate(index), bitrate);
  }
  for (const std::uint32_t none : {0U, 100'000U, 33'333U}) EXPECT_FALSE(lss_bit_timing(none));
  for (const int none : {5, 9, 10, 255}) EXPECT_FALSE(lss_bitrate(static_cast<std::uint8_t>(none)));
}

TEST(Lss, SaysWhyASlaveRefuses) {
  const auto text = [](LssService service, std::uint8_t error) {
    return lss_error_text({service, error, 0, error});
  };
  EXPECT_EQ(text(LssService::set_node, 1), "the node-ID is out of its range");
  EXPECT_EQ(text(LssService::store, 1), "it cannot store its configuration");
  EXPECT_EQ(text(LssService::store, 2), "it could not write to its memory");
  EXPECT_EQ(text(LssService::set_node, 2), "error 2, which CiA 305 does not define");
}

}  // namespace
}  // namespace servoctl::canopen
