// The two ends of a block transfer, each for itself.
#include <gtest/gtest.h>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_block.hpp"
#include "one_object.hpp"

namespace servoctl::canopen {
namespace {

SdoSegment segment(std::uint8_t first, std::uint8_t content) {
  SdoSegment out;
  out.fill(content);
  out[0] = first;
  return out;
}

/// The first bytes of the segments the sender has for this block.
std::string block(BlockSender& sender) {
  std::string out;
  while (const auto next = sender.next_segment()) out += std::to_string((*next)[0]) + " ";
  return out;
}

TEST(BlockSender, SendsBlocksOfTheSizeAskedForLast) {
  BlockSender sender;
  sender.start(counted(50), 2);
  EXPECT_EQ(sender.size(), 50U);
  EXPECT_EQ(block(sender), "1 2 ");
  EXPECT_TRUE(sender.is_waiting());
  EXPECT_EQ(sender.on_acknowledge(2, 4), 0U);
  EXPECT_FALSE(sender.is_waiting());
  EXPECT_EQ(sender.acknowledged(), 14U);
  EXPECT_EQ(block(sender), "1 2 3 4 ");
  EXPECT_EQ(sender.on_acknowledge(3, 127), 0U);
  EXPECT_EQ(sender.acknowledged(), 35U);
  EXPECT_EQ(block(sender), "1 2 131 ");
  EXPECT_FALSE(sender.is_done());
  EXPECT_EQ(sender.on_acknowledge(3, 127), 0U);
  EXPECT_TRUE(sender.is_done());
  EXPECT_EQ(sender.acknowledged(), 50U);
  EXPECT_EQ(block(sender), "");
}

TEST(BlockSender, GivesUpAfterTenAcknowledgesWithoutProgressInARow) {
  BlockSender sender;
  sender.start(counted(50), 2);
  for (int i = 0; i < 9; ++i) {
    (void)block(sender);
    EXPECT_EQ(sender.on_acknowledge(0, 2), 0U);
  }
  (void)block(sender);
  EXPECT_EQ(sender.on_acknowledge(1, 2), 0U);
  for (int i = 0; i < 9; ++i) {
    (void)block(sender);
    EXPECT_EQ(sender.on_acknowledge(0, 2), 0U);
  }
  EXPECT_EQ(sender.on_acknowledge(0, 2), sdo_abort::kSequence);
}

TEST(BlockSender, RefusesWhatCannotBe) {
  BlockSender sender;
  sender.start(counted(50), 2);
  (void)sender.next_segment();
  EXPECT_EQ(sender.on_acknowledge(2, 2), sdo_abort::kSequence);
  EXPECT_EQ(sender.on_acknowledge(1, 0), sdo_abort::kBlockSize);
  EXPECT_EQ(sender.on_acknowledge(1, 128), sdo_abort::kBlockSize);
  EXPECT_EQ(sender.on_acknowledge(1, 127), 0U);
}

TEST(BlockSender, TellsTheUnusedBytesOfItsLastSegment) {
  BlockSender sender;
  for (std::size_t size = 0; size < 30; ++size) {
    sender.start(counted(size), 127);
    EXPECT_EQ(sender.unused_bytes(), size == 0 ? 7 : (700 - size) % 7) << size;
  }
}

TEST(BlockSender, ForgetsTheTransferBefore) {
  BlockSender sender;
  sender.start(counted(5), 1);
  (void)block(sender);
  (void)sender.on_acknowledge(1, 1);
  EXPECT_TRUE(sender.is_done());
  sender.start(counted(8), 3);
  EXPECT_FALSE(sender.is_done());
  EXPECT_EQ(sender.acknowledged(), 0U);
  EXPECT_EQ(block(sender), "1 130 ");
}

TEST(BlockReceiver, EndsABlockAtItsSizeOrTheLastSegment) {
  BlockReceiver receiver;
  receiver.start(2, segment(0xC2, 9));
  EXPECT_FALSE(receiver.has_some());
  EXPECT_FALSE(receiver.on_segment(segment(1, 1)));
  EXPECT_TRUE(receiver.has_some());
  EXPECT_TRUE(receiver.on_segment(segment(2, 2)));
  EXPECT_EQ(receiver.acknowledge(), 2);
  EXPECT_FALSE(receiver.has_some());
  EXPECT_FALSE(receiver.has_last());
  EXPECT_TRUE(receiver.on_segment(segment(0x81, 3)));
  EXPECT_TRUE(receiver.has_last());
  EXPECT_EQ(receiver.received(), 21U);
  EXPECT_EQ(receiver.take(6), (Bytes{1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 3}));
  EXPECT_EQ(receiver.received(), 0U);
}

TEST(BlockReceiver, DropsWhatDoesNotFollow) {
  BlockReceiver receiver;
  receiver.start(5, segment(0xC2, 9));
  EXPECT_FALSE(receiver.on_segment(segment(0xC2, 9)));
  EXPECT_FALSE(receiver.on_segment(segment(1, 1)));
  EXPECT_FALSE(receiver.on_segment(segment(2, 2)));
  EXPECT_FALSE(receiver.on_segment(segment(0x82, 7)));
  EXPECT_FALSE(receiver.on_segment(segment(0x81, 7)));
  EXPECT_FALSE(receiver.on_segment(segment(4, 4)));
  EXPECT_TRUE(receiver.on_segment(segment(5, 5)));
  EXPECT_FALSE(receiver.on_segment(segment(5, 5)));
  EXPECT_FALSE(receiver.has_last());
  EXPECT_EQ(receiver.acknowledge(), 2);
  EXPECT_EQ(receiver.received(), 14U);
  EXPECT_TRUE(receiver.repeats(segment(5, 5)));
  EXPECT_FALSE(receiver.repeats(segment(5, 6)));
}

TEST(BlockReceiver, ForgetsTheTransferBefore) {
  BlockReceiver receiver;
  receiver.start(5, {});
  (void)receiver.on_segment(segment(0x81, 1));
  receiver.start(5, segment(0xC2, 9));
  EXPECT_FALSE(receiver.has_last());
  EXPECT_FALSE(receiver.has_some());
  EXPECT_EQ(receiver.received(), 0U);
  EXPECT_EQ(receiver.take(3), Bytes{});
}

}  // namespace
}  // namespace servoctl::canopen
