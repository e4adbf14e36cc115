#pragma once

#include "ethercat/coe_client.hpp"
#include "messages.hpp"

namespace servoctl::ethercat {
using canopen::Transfer;

class CoeClientTest : public testing::Test {
 protected:
  void upload(ObjectAddress object, std::initializer_list<std::string_view> lines) {
    client.start_upload(object, now);
    play(client, now, lines);
  }
  void download(ObjectAddress object, Bytes data, std::initializer_list<std::string_view> lines,
                Transfer transfer = Transfer::automatic, bool complete = false) {
    client.start_download(object, std::move(data), now, transfer, complete);
    play(client, now, lines);
  }
  Result<Bytes> result() {
    auto first = client.take_result();
    EXPECT_TRUE(first) << "the transfer has not ended";
    EXPECT_FALSE(client.take_result()) << "two results";
    EXPECT_FALSE(client.busy());
    EXPECT_EQ(client.deadline(), kNever);
    return first ? *first : Result<Bytes>(fail(Errc::bug, "none"));
  }
  std::string data() {
    const auto r = result();
    return r ? to_hex(*r) : r.error().message.text();
  }
  void expect_failure(Errc code, std::string_view message, std::optional<std::uint32_t> abort = {}) {
    const auto r = result();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code);
    EXPECT_EQ(r.error().message.text(), message);
    EXPECT_EQ(r.error().abort_code, abort);
    EXPECT_EQ(r.error().node, 2);
    EXPECT_TRUE(r.error().object);
  }

  CoeClient client{2, std::chrono::milliseconds(500), 26};  // A mailbox of 32 bytes.
  TimePoint now{std::chrono::seconds(1)};
};

inline Bytes counted(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i + 1);
  return out;
}

}  // namespace servoctl::ethercat
