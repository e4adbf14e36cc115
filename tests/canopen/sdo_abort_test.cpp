#include "canopen/sdo_abort.hpp"

#include <gtest/gtest.h>

#include <ios>
#include <utility>

namespace servoctl::canopen {
namespace {

TEST(SdoAbort, HasTheTextOfCia301) {
  // CiA 301 v4.2, 7.2.4.3.17.
  const std::pair<std::uint32_t, const char*> rows[] = {
      {0x0503'0000, "toggle bit not alternated"},
      {0x0504'0000, "SDO protocol timed out"},
      {0x0504'0001, "command specifier not valid or unknown"},
      {0x0504'0002, "invalid block size"},
      {0x0504'0003, "invalid sequence number"},
      {0x0504'0004, "CRC error"},
      {0x0504'0005, "out of memory"},
      {0x0601'0000, "unsupported access to an object"},
      {0x0601'0001, "attempt to read a write-only object"},
      {0x0601'0002, "attempt to write a read-only object"},
      {0x0602'0000, "object does not exist in the object dictionary"},
      {0x0604'0041, "object cannot be mapped to the PDO"},
      {0x0604'0042, "number and length of the mapped objects exceed the PDO length"},
      {0x0604'0043, "general parameter incompatibility"},
      {0x0604'0047, "general internal incompatibility in the device"},
      {0x0606'0000, "access failed due to a hardware error"},
      {0x0607'0010, "data type does not match, length of service parameter does not match"},
      {0x0607'0012, "data type does not match, length of service parameter too high"},
      {0x0607'0013, "data type does not match, length of service parameter too low"},
      {0x0609'0011, "sub-index does not exist"},
      {0x0609'0030, "invalid value for parameter"},
      {0x0609'0031, "value of parameter written too high"},
      {0x0609'0032, "value of parameter written too low"},
      {0x0609'0036, "maximum value is less than minimum value"},
      {0x060A'0023, "resource not available: SDO connection"},
      {0x0800'0000, "general error"},
      {0x0800'0020, "data cannot be transferred or stored to the application"},
      {0x0800'0021, "data cannot be transferred or stored to the application because of local control"},
      {0x0800'0022,
       "data cannot be transferred or stored to the application because of the present device state"},
      {0x0800'0023, "object dictionary dynamic generation failed or no object dictionary is present"},
      {0x0800'0024, "no data available"},
  };
  for (const auto& [code, text] : rows) {
    EXPECT_EQ(sdo_abort_text(code), text);
    EXPECT_TRUE(is_standard_sdo_abort(code)) << text;
    EXPECT_NE(sdo_abort_hint(code), "look the code up in the drive's manual") << text;
  }
}

TEST(SdoAbort, HasTheCodesThatEtherCatAdds) {
  // ETG.1000.6, table 41; SOEM and ethercrab have the same.
  for (const std::uint32_t code : {0x0601'0003U, 0x0601'0004U, 0x0601'0005U, 0x0601'0006U, 0x0609'0033U}) {
    EXPECT_FALSE(is_standard_sdo_abort(code)) << "CiA 301 does not list it";
    EXPECT_EQ(sdo_abort_text(code).find("not listed"), std::string::npos);
    EXPECT_NE(sdo_abort_hint(code), "look the code up in the drive's manual");
  }
  EXPECT_EQ(sdo_abort_text(0x0601'0006), "object is mapped to an RxPDO, download blocked");
}

TEST(SdoAbort, OfAVendorIsNamedByItsClass) {
  EXPECT_FALSE(is_standard_sdo_abort(0x0504'0022));
  EXPECT_EQ(sdo_abort_text(0x0504'0022), "service error not listed in CiA 301");
  EXPECT_EQ(sdo_abort_text(0x0606'0010), "access error not listed in CiA 301");
  EXPECT_EQ(sdo_abort_text(0x0801'0000), "other error not listed in CiA 301");
  for (const std::uint32_t code : {0x0F00'1234U, 0x0400'0000U, 0x0700'0000U, 0x0900'0000U, 0U})
    EXPECT_EQ(sdo_abort_text(code), "vendor-specific code, not listed in CiA 301");
  EXPECT_EQ(sdo_abort_hint(0x0504'0022), "look the code up in the drive's manual");
  EXPECT_EQ(sdo_abort_hint(0x0504'0002), "");
}

TEST(SdoAbort, OfWhatIsWrittenInStepsNamesThem) {  // CiA 301, 7.5.2.19, 7.5.2.22, 7.5.2.36
  for (const auto code : {sdo_abort::kUnsupportedAccess, sdo_abort::kGeneral, sdo_abort::kDeviceState}) {
    for (const ObjectAddress object : {ObjectAddress{0x1600, 1}, {0x1A03, 0}, {0x1800, 2}})
      EXPECT_NE(sdo_abort_hint(code, object).find("`pdo map`"), std::string::npos);
    EXPECT_NE(sdo_abort_hint(code, {0x1019, 0}).find("1006h"), std::string::npos);
    EXPECT_EQ(sdo_abort_hint(code, {0x605A, 0}), sdo_abort_hint(code));
  }
  EXPECT_NE(sdo_abort_hint(sdo_abort::kIncompatible, {0x1016, 2}).find("another entry"), std::string::npos);
  EXPECT_EQ(sdo_abort_hint(sdo_abort::kRange, {0x1600, 1}), sdo_abort_hint(sdo_abort::kRange));
}

TEST(SdoAbort, OfTheKindOfTransferLeavesTheObjectOpen) {
  for (const auto code : {sdo_abort::kCommand, sdo_abort::kBlockSize, sdo_abort::kOutOfMemory,
                          sdo_abort::kUnsupportedAccess, sdo_abort::kGeneral})
    EXPECT_TRUE(refuses_block_transfer(code)) << std::hex << code;
  for (const auto code : {sdo_abort::kNoObject, sdo_abort::kTimeout, sdo_abort::kWriteOnly, 0x1234U})
    EXPECT_FALSE(refuses_block_transfer(code)) << std::hex << code;
}

}  // namespace
}  // namespace servoctl::canopen
