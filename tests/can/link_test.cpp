#include "can/link.hpp"

#include <gtest/gtest.h>

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>

#include <cstring>

namespace servoctl::can {
namespace {

Bytes bytes_of(const void* data, std::size_t size) {
  const auto* begin = static_cast<const std::uint8_t*>(data);
  return {begin, begin + size};
}

Bytes attribute(std::uint16_t type, Bytes data) {
  rtattr head{static_cast<unsigned short>(sizeof(rtattr) + data.size()), type};
  auto out = bytes_of(&head, sizeof head);
  out.insert(out.end(), data.begin(), data.end());
  out.resize(RTA_ALIGN(out.size()));
  return out;
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes out;
  for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

/// The kernel's answer for an interface of this kind.
Bytes answer(const char* kind, const Bytes& data) {
  const auto info =
      attribute(IFLA_LINKINFO, joined({attribute(IFLA_INFO_KIND, bytes_of(kind, std::strlen(kind) + 1)),
                                       attribute(IFLA_INFO_DATA, data)}));
  const auto body = joined({attribute(IFLA_IFNAME, bytes_of("can0", 5)), info});
  nlmsghdr head{};
  head.nlmsg_len = static_cast<std::uint32_t>(NLMSG_LENGTH(sizeof(ifinfomsg)) + body.size());
  head.nlmsg_type = RTM_NEWLINK;
  const ifinfomsg link{};
  return joined({bytes_of(&head, sizeof head), bytes_of(&link, sizeof link), body});
}

Bytes can_data() {
  can_bittiming timing{};
  timing.bitrate = 500'000;
  const std::uint32_t state = CAN_STATE_ERROR_PASSIVE;
  const can_berr_counter counters{130, 7};
  return joined({attribute(IFLA_CAN_BITTIMING, bytes_of(&timing, sizeof timing)),
                 attribute(IFLA_CAN_STATE, bytes_of(&state, sizeof state)),
                 attribute(IFLA_CAN_BERR_COUNTER, bytes_of(&counters, sizeof counters))});
}

TEST(Link, TellsBitrateHealthAndErrorCounters) {
  const auto link = parse_link(answer("can", can_data()));
  ASSERT_TRUE(link.has_value());
  EXPECT_EQ(link->bitrate, 500'000U);
  EXPECT_EQ(link->health, LinkHealth::error_passive);
  EXPECT_EQ(link->tx_errors, 130);
  EXPECT_EQ(link->rx_errors, 7);
}

TEST(Link, OfAVirtualInterfaceHasNothingInIt) {
  const auto link = parse_link(answer("vcan", can_data()));
  ASSERT_TRUE(link.has_value());
  EXPECT_FALSE(link->bitrate || link->health || link->tx_errors || link->rx_errors);
}

TEST(Link, StandsAnAnswerThatIsCutAnywhere) {
  const auto whole = answer("can", can_data());
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(parse_link(ByteSpan(whole).first(size)).has_value()) << size;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (const std::uint8_t byte : Bytes{0x00, 0x01, 0x7F, 0xFF}) {
      auto bent = whole;
      bent[i] = byte;
      (void)parse_link(bent);
    }
}

TEST(Link, OfNoInterfaceIsEmpty) { EXPECT_FALSE(link_state("no-such-can").has_value()); }

}  // namespace
}  // namespace servoctl::can
