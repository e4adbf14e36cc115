#include "canopen/emergency.hpp"

#include <ios>
#include <vector>

#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

TEST(Emergency, IsTakenApart) {
  const auto e = parse_emergency(frame("083#30811105060708AA"));
  ASSERT_TRUE(e);
  EXPECT_EQ(e->node, 3);
  EXPECT_EQ(e->code, 0x8130);
  EXPECT_EQ(e->error_register, 0x11);
  EXPECT_EQ(e->vendor, (std::array<std::uint8_t, 5>{5, 6, 7, 8, 0xAA}));
  EXPECT_EQ(can::to_string(emergency_frame(*e)), "083#30811105060708AA");
}

TEST(Emergency, OfTwoBytesIsUnderstoodAndSyncIsNone) {
  EXPECT_EQ(parse_emergency(frame("081#1615"))->code, 0x1516);
  auto longer = frame("081#1615818283");
  longer.size = 2;  // What stands behind the end of a frame is no part of it.
  EXPECT_EQ(parse_emergency(longer)->error_register, 0);
  EXPECT_EQ(parse_emergency(longer)->vendor, (std::array<std::uint8_t, 5>{}));
  EXPECT_EQ(parse_emergency(frame("081#1615818283"))->vendor, (std::array<std::uint8_t, 5>{0x82, 0x83}));
  EXPECT_FALSE(parse_emergency(frame("080#")));
  EXPECT_FALSE(parse_emergency(frame("080#01")));
  EXPECT_FALSE(parse_emergency(frame("081#16")));
  EXPECT_FALSE(parse_emergency(frame("100#0000000000000000")));
}

TEST(Emergency, IsOfANodeAndAPlainFrame) {
  EXPECT_EQ(parse_emergency(frame("081#0010"))->node, 1);
  EXPECT_EQ(parse_emergency(frame("0FF#0010"))->node, 127);
  EXPECT_EQ(parse_emergency(frame("0FF#00100203"))->size, 4);
  for (const auto* text : {"080#0010000000000000", "07F#0010", "100#0010", "081#00"})
    EXPECT_FALSE(parse_emergency(frame(text))) << text;
  std::vector<can::Frame> flagged(3, frame("081#0010"));
  flagged[0].extended = true;
  flagged[1].remote = true;
  flagged[2].error = true;
  for (const auto& other : flagged) EXPECT_FALSE(parse_emergency(other));
}

TEST(Emergency, IsAResetByItsHighByteAlone) {
  EXPECT_TRUE(parse_emergency(frame("081#0000"))->is_reset());
  EXPECT_TRUE(parse_emergency(frame("081#FF00"))->is_reset());
  EXPECT_FALSE(parse_emergency(frame("081#0001"))->is_reset());
}

TEST(Emergency, HasATextForEveryCode) {
  struct Range {
    std::uint32_t last;
    std::string_view text;
  };
  // CiA 301 v4.2, table 26.
  const std::vector<Range> ranges = {{0x00FF, "error reset or no error"},
                                     {0x0FFF, "not listed in CiA 301"},
                                     {0x10FF, "generic error"},
                                     {0x1FFF, "not listed in CiA 301"},
                                     {0x20FF, "current, generic"},
                                     {0x21FF, "current, input side"},
                                     {0x22FF, "current inside the device"},
                                     {0x23FF, "current, output side"},
                                     {0x2FFF, "current"},
                                     {0x30FF, "voltage, generic"},
                                     {0x31FF, "mains voltage"},
                                     {0x32FF, "voltage inside the device"},
                                     {0x33FF, "output voltage"},
                                     {0x3FFF, "voltage"},
                                     {0x40FF, "temperature, generic"},
                                     {0x41FF, "ambient temperature"},
                                     {0x42FF, "device temperature"},
                                     {0x4FFF, "temperature"},
                                     {0x5FFF, "device hardware"},
                                     {0x60FF, "device software, generic"},
                                     {0x61FF, "internal software"},
                                     {0x62FF, "user software"},
                                     {0x63FF, "data set"},
                                     {0x6FFF, "device software"},
                                     {0x7FFF, "additional modules"},
                                     {0x80FF, "monitoring"},
                                     {0x810F, "communication, generic"},
                                     {0x8110, "CAN overrun: messages lost"},
                                     {0x811F, "communication, generic"},
                                     {0x8120, "CAN in error passive mode"},
                                     {0x812F, "communication, generic"},
                                     {0x8130, "life guard or heartbeat error"},
                                     {0x813F, "communication, generic"},
                                     {0x8140, "recovered from bus-off"},
                                     {0x814F, "communication, generic"},
                                     {0x8150, "CAN-ID collision"},
                                     {0x81FF, "communication, generic"},
                                     {0x820F, "protocol error, generic"},
                                     {0x8210, "PDO not processed: length error"},
                                     {0x821F, "protocol error, generic"},
                                     {0x8220, "PDO length exceeded"},
                                     {0x822F, "protocol error, generic"},
                                     {0x8230, "DAM MPDO not processed, destination object not available"},
                                     {0x823F, "protocol error, generic"},
                                     {0x8240, "unexpected SYNC data length"},
                                     {0x824F, "protocol error, generic"},
                                     {0x8250, "RPDO timed out"},
                                     {0x82FF, "protocol error, generic"},
                                     {0x8FFF, "monitoring"},
                                     {0x90FF, "external error"},
                                     {0xEFFF, "not listed in CiA 301"},
                                     {0xF0FF, "additional functions"},
                                     {0xFEFF, "not listed in CiA 301"},
                                     {0xFFFF, "device specific"}};
  std::uint32_t code = 0;
  for (const auto& range : ranges)
    for (; code <= range.last; ++code)
      ASSERT_EQ(emergency_text(static_cast<std::uint16_t>(code)), range.text) << std::hex << code;
}

TEST(ErrorRegister, HasANameForEveryBit) {
  const char* names[] = {"generic",       "current",        "voltage",  "temperature",
                         "communication", "device profile", "reserved", "manufacturer"};
  for (unsigned bit = 0; bit < 8; ++bit)
    EXPECT_EQ(error_register_text(static_cast<std::uint8_t>(1U << bit)), names[bit]);
  EXPECT_EQ(error_register_text(0), "none");
  EXPECT_EQ(error_register_text(0x91), "generic, communication, manufacturer");
}

}  // namespace
}  // namespace servoctl::canopen
