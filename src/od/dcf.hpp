#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::od {

/// What a device configuration file says beside the data sheet it is made from (CiA 306-1, 5).
struct DcfSettings {
  std::string file_name;              ///< FileName; LastEDS is the FileName of the data sheet.
  std::string date;                   ///< ModificationDate, `11-18-2026`; empty: that of the data sheet.
  std::string time;                   ///< ModificationTime, `11:06AM`.
  std::uint8_t node_id = 0;           ///< 1..127.
  std::string node_name;              ///< NodeName; may be empty.
  std::optional<std::uint32_t> kbps;  ///< Baudrate in kbit/s, where known.
  std::map<ObjectAddress, Value> values;
};

/// The data sheet with a ParameterValue for each of the values and with [DeviceComissioning] (so spelt in the
/// standard); comments that are no section are dropped. The same input gives the same text. A value whose
/// object has no place in the data sheet, or whose text cannot stand in a line, is not in it: read_dcf()
/// tells. Errc::file when the data sheet cannot be used.
Result<std::string> write_dcf(std::string_view eds, const DcfSettings& settings);

/// One ParameterValue.
struct DcfValue {
  ObjectAddress object;
  DataType type = DataType::u32;  ///< By the file.
  NodeValue value;
  std::uint32_t line = 0;  ///< Of the file, from 1.
};

/// What a device configuration file wants a device to hold.
struct Dcf {
  std::uint8_t node_id = 0;      ///< 0: not said.
  std::vector<DcfValue> values;  ///< In rising address; without those of domains, which have none.
};

/// Reads a DCF of any tool. Unlike read_eds() it leaves out no value: Errc::file, with the line, for a
/// ParameterValue that cannot be used, that stands twice or whose object is described wrongly, and when there
/// is none at all. `file` is used in messages.
Result<Dcf> read_dcf(std::string_view text, std::string_view file);

}  // namespace servoctl::od
