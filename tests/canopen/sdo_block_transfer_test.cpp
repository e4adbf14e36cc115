#include "canopen/sdo_block.hpp"

#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

/// A client and a server with a line between them that loses and doubles frames.
class Line {
 public:
  Line(OneObject& object, SdoServer::Options options) : server(2, object, options) {}

  /// Runs until the client has its result; `fate` says for each frame how many copies arrive.
  template <class Fate>
  Result<Bytes> run(Fate fate) {
    for (int round = 0; round < 200'000; ++round) {
      bool moved = false;
      while (const auto sent = client.take_frame()) {
        moved = true;
        for (int copies = fate(); copies > 0; --copies) server.on_frame(*sent, now);
      }
      while (const auto sent = server.take_frame()) {
        moved = true;
        for (int copies = fate(); copies > 0; --copies) client.on_frame(*sent, now);
      }
      if (auto result = client.take_result()) return std::move(*result);
      if (moved) continue;
      now = std::max(now, std::min(client.deadline(), server.deadline()));
      client.on_time(now);
      server.on_time(now);
    }
    return fail(Errc::bug, "it never ends");
  }

  SdoClient client{2, 500ms};
  SdoServer server;
  TimePoint now{1s};
};

RC_GTEST_PROP(BlockTransfer, CarriesAnyDataInAnyBlockSize, ()) {
  const auto data = *rc::gen::container<Bytes>(rc::gen::arbitrary<std::uint8_t>());
  SdoServer::Options options;
  options.block_size = *rc::gen::inRange<std::uint8_t>(1, 128);
  options.crc = *rc::gen::arbitrary<bool>();
  OneObject object;
  Line line(object, options);
  line.client.start_download({0x1F50, 1}, data, line.now, Transfer::block);
  RC_ASSERT(line.run([] { return 1; }).has_value());
  RC_ASSERT(object.value == data);
  line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
  const auto read = line.run([] { return 1; });
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == data);
}

TEST(BlockTransfer, GetsOverTheLossOfAnySingleSegment) {
  for (int lost = 0; lost < 100; ++lost) {
    OneObject object;
    Line line(object, {});
    int segment =
        -3;  // Request and answer go before the first segment of a write; the start too before one of a read.
    const auto fate = [&] { return segment++ == lost ? 0 : 1; };
    line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
    object.value = counted(700);
    const auto read = line.run(fate);
    ASSERT_TRUE(read) << lost << ": " << read.error().message.text();
    EXPECT_EQ(*read, counted(700));
    segment = -2;
    line.client.start_download({0x1F50, 1}, counted(700), line.now, Transfer::block);
    ASSERT_TRUE(line.run(fate)) << lost;
    EXPECT_EQ(object.value, counted(700));
  }
}

RC_GTEST_PROP(BlockTransfer, NeverDeliversWrongDataOverALineThatLosesAndDoublesFrames, ()) {
  const auto size = *rc::gen::inRange<std::size_t>(0, 3000);
  Bytes data(size);
  for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i * 31 + i / 256);
  auto seed = *rc::gen::inRange<std::uint32_t>(1, 1'000'000);
  const auto one_in = *rc::gen::inRange<std::uint32_t>(5, 400);
  const auto fate = [&] {
    seed = seed * 1664525U + 1013904223U;
    const auto draw = (seed >> 8U) % one_in;
    return draw == 0 ? 0 : draw == 1 ? 2 : 1;
  };
  SdoServer::Options options;
  options.block_size = *rc::gen::inRange<std::uint8_t>(1, 128);
  OneObject object;
  Line line(object, options);
  line.client.start_download({0x1F50, 1}, data, line.now, Transfer::block);
  const auto written = line.run(fate);
  RC_ASSERT((!written.has_value() || object.value == data));
  RC_ASSERT((written.has_value() || written.error().code != Errc::bug));
  object.value = data;
  line.server.reset();
  (void)line.client.take_frame();
  line.client.start_upload({0x1F50, 1}, line.now, Transfer::block);
  const auto read = line.run(fate);
  RC_ASSERT((!read.has_value() || *read == data));
  RC_ASSERT((read.has_value() || read.error().code != Errc::bug));
}

}  // namespace
}  // namespace servoctl::canopen
