#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "od/eds.hpp"
#include "od/esi.hpp"

namespace servoctl::od {

/// A data sheet as the user names it: `drive.eds`, or `drive.xml#2` for one of several devices of an ESI.
struct SheetName {
  std::string path;
  std::string device;  ///< What stands behind the `#`; empty: there is one device.
};

SheetName sheet_name(std::string_view word);

/// Whether the text is XML, so that a data sheet of it is an ESI and no EDS.
bool is_xml(std::string_view bytes);

/// Reads an EDS, a DCF or a device of an ESI, whichever the text is. `word` is as for sheet_name(); errors
/// are those of read_eds() and read_esi().
Result<EdsFile> read_data_sheet(std::string_view bytes, std::string_view word);

/// The file of a data sheet. Errc::file when it cannot be read or is larger than any data sheet.
Result<std::string> read_sheet_file(std::string_view word);

}  // namespace servoctl::od
