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
  std::uint8_t node_id = 0;         ///< 0: not said.
  std::uint32_t vendor_number = 0;  ///< Of [DeviceInfo], as 1018h:01 and :02; 0: not said.
  std::uint32_t product_number = 0;
  std::vector<DcfValue> values;  ///< In rising address; without those of domains, which have none.
  /// ParameterValues that cannot be used: no value of their type, twice there, of an object that is described
  /// wrongly or not at all. Errc::file, with the line, in its order.
  std::vector<Error> unusable;
  /// ParameterValues that mean nothing: of a record or array as a whole, or in a list ([2100Value]) beside
  /// the same sub-index with one of its own. With the line.
  std::vector<Message> passed_over;
};

/// Reads a DCF of any tool. Unlike read_eds() it leaves out no value without a word: see Dcf::unusable.
/// Errc::file when there is no ParameterValue at all. `file` is used in messages.
Result<Dcf> read_dcf(std::string_view text, std::string_view file);

}  // namespace servoctl::od
