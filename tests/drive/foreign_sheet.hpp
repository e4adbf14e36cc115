#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/foreign_table.hpp"
#include "od/data_sheet.hpp"

namespace servoctl::drive {

inline constexpr std::string_view kForeignSheet =
    "[DeviceInfo]\nVendorName=Maker \"A\"\nVendorNumber=0x1234\nProductName=P10\nProductNumber=0x55\n"
    "[MandatoryObjects]\nSupportedObjects=1\n1=0x1018\n"
    "[1018]\nParameterName=Identity\nObjectType=0x9\nSubNumber=3\n"
    "[1018sub0]\nParameterName=n\nObjectType=0x7\nDataType=0x0005\nAccessType=ro\nDefaultValue=2\nPDOMapping=0\n"
    "[1018sub1]\nParameterName=v\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nPDOMapping=0\n"
    "[1018sub2]\nParameterName=p\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nPDOMapping=0\n"
    "[ManufacturerObjects]\nSupportedObjects=4\n1=0x2001\n2=0x2002\n3=0x2003\n4=0x2004\n"
    "[2001]\nParameterName=P1-01 Speed gain\nObjectType=0x7\nDataType=0x0006\nAccessType=rw\nLowLimit=1\n"
    "HighLimit=2000\nDefaultValue=400\nPDOMapping=0\n"
    "[2002]\nParameterName=P1-02 Brake delay\nObjectType=0x7\nDataType=0x0006\nAccessType=rw\nPDOMapping=0\n"
    "[2003]\nParameterName=P1-03 Actual torque\nObjectType=0x7\nDataType=0x0003\nAccessType=ro\nPDOMapping=0\n"
    "[2004]\nParameterName=Filters\nObjectType=0x8\nDataType=0x0006\nAccessType=rw\nPDOMapping=0\n"
    "CompactSubObj=20\n";

inline od::EdsFile foreign_sheet() { return od::read_data_sheet(kForeignSheet, "p10.eds").value(); }

/// What becomes of a table.
struct Converted {
  ConvertedTable table;
  std::vector<Error> errors;
  /// Messages and hints, a line each.
  std::string wrong() const {
    std::string out;
    for (const auto& error : errors) out += error.message.text() + "; " + error.hint.text() + "\n";
    return out;
  }
  std::string notices() const {
    std::string out;
    for (const auto& notice : table.notices) out += notice.text() + "\n";
    return out;
  }
};

inline Converted convert(std::string_view csv) {
  Converted out;
  out.table = convert_parameters(csv, "t.csv", foreign_sheet().dictionary, out.errors);
  return out;
}

inline Converted convert_fault_table(std::string_view csv) {
  Converted out;
  out.table = convert_faults(csv, "f.csv", out.errors);
  return out;
}

}  // namespace servoctl::drive
