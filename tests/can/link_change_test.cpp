// Messages to and from the kernel, held against what iproute2 and Linux wrote (tests/vectors/rtnetlink.txt).
#include "can/link_change.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>
#include <sstream>

#include "can/route_socket.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::can {
namespace {

Bytes vector_of(const std::string& wanted) {
  std::ifstream file(std::string(source_dir()) + "/tests/vectors/rtnetlink.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name, hex;
    words >> name >> hex;
    if (name != wanted) continue;
    Bytes out;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
      out.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    return out;
  }
  ADD_FAILURE() << "there is no vector " << wanted;
  return {};
}

const LinkChange kSet{.bitrate = 500'000, .sample_point = 800, .restart_ms = 100, .listen_only = true};

TEST(LinkChange, IsTheMessageOfIproute2) {
  EXPECT_EQ(link_message(2, kSet), vector_of("set"));
  EXPECT_EQ(link_message(2, {.up = true, .bitrate = 250'000}), vector_of("up"));
}

TEST(LinkChange, IsShownAsTheCommandOfIproute2) {
  EXPECT_EQ(ip_command("can0", kSet),
            "ip link set can0 type can bitrate 500000 sample-point 0.800 restart-ms 100 listen-only on");
  EXPECT_EQ(ip_command("can0", {.up = true, .bitrate = 250'000}),
            "ip link set can0 up type can bitrate 250000");
  EXPECT_EQ(ip_command("can0", {.up = false}), "ip link set can0 down");
  EXPECT_EQ(ip_command("vcan0", {.up = true, .queue_length = 1000}), "ip link set vcan0 up txqueuelen 1000");
}

TEST(LinkState, OfAControllerIsReadWhole) {
  const auto link = parse_link(vector_of("sja1000"));
  ASSERT_TRUE(link.has_value());
  EXPECT_EQ(link->kind, "can");
  EXPECT_FALSE(link->up);
  EXPECT_EQ(link->bitrate, 500'000U);
  EXPECT_EQ(link->sample_point, 750);  // 8 quanta have no 0.8.
  EXPECT_EQ(link->quanta, 16U);
  EXPECT_EQ(link->clock, 8'000'000U);
  EXPECT_EQ(link->restart_ms, 100U);
  EXPECT_EQ(link->queue_length, 10U);
  EXPECT_TRUE(link->listen_only);
  EXPECT_EQ(link->can_listen_only, true);
  EXPECT_FALSE(link->loopback);
  EXPECT_EQ(link->health, LinkHealth::stopped);
  EXPECT_TRUE(link->bitrates.empty());
  ASSERT_TRUE(link->history.has_value());
  EXPECT_EQ(link->history->bus_off, 0U);
}

TEST(LinkState, OfAnAdapterWithBitratesOfItsOwnListsThem) {
  const auto link = parse_link(vector_of("slcan"));
  ASSERT_TRUE(link.has_value());
  EXPECT_EQ(link->bitrates, (std::vector<std::uint32_t>{10'000, 20'000, 50'000, 100'000, 125'000, 250'000,
                                                        500'000, 800'000, 1'000'000}));
  EXPECT_EQ(link->bitrate, 500'000U);
  EXPECT_EQ(link->quanta, 0U);
  EXPECT_EQ(link->restart_ms, 0U);
  EXPECT_EQ(link->can_listen_only, true);
}

TEST(LinkState, StandsARealAnswerThatIsCutOrBentAnywhere) {
  const auto whole = vector_of("sja1000");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(parse_link(ByteSpan(whole).first(size)));
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (const std::uint8_t byte : Bytes{0x00, 0x01, 0x7F, 0xFF}) {
      auto bent = whole;
      bent[i] = byte;
      (void)parse_link(bent);
      (void)parse_route_answer(bent);
    }
}

TEST(RouteAnswer, HasTheErrorAndTheWordsOfTheKernel) {
  const auto answer = parse_route_answer(vector_of("refused"));
  EXPECT_EQ(answer.error, EOPNOTSUPP);
  EXPECT_EQ(answer.words, "Device doesn't support restart from Bus Off");
  const auto whole = vector_of("refused");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_EQ(parse_route_answer(ByteSpan(whole).first(size)).error, EBADMSG) << size;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto bent = whole;
    bent[i] ^= 0xFFU;
    (void)parse_route_answer(bent);
  }
}

LinkState controller() {
  LinkState out;
  out.kind = "can";
  out.clock = 8'000'000;
  return out;
}

TEST(LinkRefusal, SaysInWordsWhatTheKernelMeans) {
  const LinkChange bits{.up = true, .bitrate = 777'777};
  const auto no_right = link_refusal("can0", bits, controller(), EPERM, {});
  EXPECT_EQ(no_right.message, "can0 was not changed: this user may not change interfaces");
  EXPECT_NE(no_right.hint.text().find("sudo"), std::string::npos);
  EXPECT_NE(no_right.hint.text().find("setcap cap_net_admin+ep"), std::string::npos);
  EXPECT_EQ(link_refusal("can0", bits, controller(), EDOM, {}).message,
            "can0 cannot make 777777 bit/s from its clock of 8 MHz");
  EXPECT_EQ(link_refusal("can0", bits, controller(), EINVAL, {}).code, Errc::usage);
  EXPECT_NE(link_refusal("can0", bits, controller(), EBUSY, {}).message.text().find("can0 is up"),
            std::string::npos);
  auto fixed = controller();
  fixed.bitrates = {250'000, 500'000};
  EXPECT_EQ(link_refusal("can0", bits, fixed, EINVAL, {}).hint, "it has 250 kbit/s, 500 kbit/s");
  LinkState virtual_one;
  virtual_one.kind = "vcan";
  EXPECT_EQ(link_refusal("vcan0", bits, virtual_one, EOPNOTSUPP, {}).message,
            "vcan0 (vcan) has no bitrate to set");
  EXPECT_EQ(link_refusal("can0", {.restart_ms = 100}, controller(), EOPNOTSUPP, "No").message,
            "the driver of can0 does not restart by itself after a bus-off (the kernel: No)");
  EXPECT_EQ(link_refusal("can0", {.listen_only = true}, controller(), EOPNOTSUPP, {}).message,
            "the driver of can0 cannot listen without acknowledging");
  EXPECT_EQ(link_refusal("can0", {.up = true}, controller(), EINVAL, {}).message, "can0 has no bitrate yet");
  EXPECT_EQ(link_refusal("can0", {.up = true}, controller(), ENODEV, {}).message, "can0 is gone");
}

TEST(LinkRight, IsWhatTheKernelAnswersToAChangeOfNothing) {
  EXPECT_EQ(may_change_links(EPERM), false);
  EXPECT_EQ(may_change_links(EINVAL), true);
  EXPECT_FALSE(may_change_links(ETIMEDOUT).has_value());
}

TEST(LinkReceivers, AreCountedBySocketNotByEntry) {
  // /proc/net/can of Linux 6.1, one reader of can0 with two filters and one that wants errors as well.
  constexpr std::string_view kLists =
      "\nreceive list 'rx_all':\n  (any: no entry)\n"
      "  device   can_id   can_mask      function          userdata       matches  ident\n"
      "   can0      000    00000000  000000004f35a3a9  00000000dcafa4cc         0  raw\n"
      "   can0      000    00000000  000000004f35a3a9  00000000dcafa4cd         0  raw\n"
      "  (can1: no entry)\n\nreceive list 'rx_err':\n"
      "   can0      000    1fffffff  000000004f35a3a9  00000000dcafa4cc         0  raw\n";
  EXPECT_EQ(count_receivers(kLists, "can0"), 2U);
  EXPECT_EQ(count_receivers(kLists, "can1"), 0U);
}

TEST(LinkOpen, RefusesWhatIsNoCanInterface) {
  EXPECT_EQ(open_link("no/name").error().code, Errc::usage);
  EXPECT_EQ(open_link("no-such-can").error().code, Errc::bus);
  EXPECT_EQ(open_link("lo").error().message.text(), "lo is not a CAN interface");
}

/// An interface that remembers what was done to it.
class FakeLink final : public LinkControl {
 public:
  explicit FakeLink(LinkState state) : state_(std::move(state)) {}
  const std::string& name() const override { return name_; }
  Result<LinkState> state() override { return state_; }
  Result<void> change(const LinkChange& change) override {
    done.push_back(ip_command(name_, change));
    if (change.listen_only) state_.listen_only = *change.listen_only;
    return {};
  }
  Result<std::unique_ptr<Bus>> listen() override { return fail(Errc::bus, "not here"); }

  std::vector<std::string> done;

 private:
  std::string name_ = "can0";
  LinkState state_;
};

TEST(LinkKeeper, PutsBackWhatWasThereUnlessItIsKept) {
  auto before = controller();
  before.up = true;
  before.bitrate = 500'000;
  before.sample_point = 875;
  FakeLink link(before);
  {
    const LinkKeeper keeper(link, before);
    (void)link.change({.listen_only = true});
  }
  EXPECT_EQ(link.done,
            (std::vector<std::string>{
                "ip link set can0 type can listen-only on", "ip link set can0 down",
                "ip link set can0 up type can bitrate 500000 sample-point 0.875 listen-only off"}));
  link.done.clear();
  {
    LinkKeeper keeper(link, before);
    keeper.keep();
  }
  EXPECT_TRUE(link.done.empty());
}

}  // namespace
}  // namespace servoctl::can
