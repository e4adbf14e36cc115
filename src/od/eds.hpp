#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::od {

enum class Severity : std::uint8_t { warning, error };

/// One finding in a file.
struct Diagnostic {
  Severity severity = Severity::error;
  std::uint32_t line = 0;    ///< From 1.
  std::uint32_t column = 0;  ///< From 1, in bytes.
  std::string rule;          ///< Short stable name, such as `missing-data-type`; for filters and scripts.
  std::string message;       ///< What is wrong.
  std::string remedy;        ///< What to change.
  std::uint32_t count = 1;   ///< Above 1: stands for that many findings of its rule that are left out.
  std::string section = {};  ///< `1018sub1`, as the file writes it; empty before the first one.
  std::string key = {};      ///< `LowLimit`; empty where it is none.
};

/// What an EDS or DCF says of the device beside its objects.
struct DeviceInfo {
  std::string vendor_name;
  std::string product_name;
  std::uint32_t vendor_number = 0;
  std::uint32_t product_number = 0;
  std::uint32_t revision_number = 0;
  std::vector<std::uint32_t> bitrates;  ///< kbit/s that are marked as supported.
  std::vector<DataType> dummies;        ///< Types that may fill gaps in an RPDO: [DummyUsage], 0001h-0007h.
};

/// What a DCF says of an entry beside its value (CiA 306-1, 5.3).
struct EntryNote {
  ObjectAddress address;
  std::string denotation;     ///< The application's name for the entry.
  std::string upload_file;    ///< Where a DOMAIN read from the device goes.
  std::string download_file;  ///< What is written into a DOMAIN.
};

/// An EDS, a DCF or a device of an ESI read in full: everything usable, and everything that was not.
struct EdsFile {
  DeviceInfo device;
  bool ethercat = false;     ///< Of an ESI: `device` is what a master knows it by.
  bool learned = false;      ///< Has the comment kLearnedMark: `ro` may only mean that nobody knows more.
  std::uint8_t node_id = 0;  ///< DCF only, 0 otherwise.
  Dictionary dictionary;
  std::vector<EntryNote> notes;         ///< Only of entries that have one; in rising address.
  std::vector<Diagnostic> diagnostics;  ///< In rising line.

  std::size_t error_count() const;
  std::size_t warning_count() const;
};

/// Far above any data sheet; what is larger is refused unread.
constexpr std::size_t kMostEdsBytes = 32U << 20U;

/// Reads an electronic data sheet or device configuration file (CiA 306-1) in any encoding to_utf8() knows. A
/// bad entry is reported and skipped, never the whole file; Errc::file only when there is not one object in
/// it, when it is no text, or larger than kMostEdsBytes. Time and memory are linear in its length. `file` is
/// used in messages.
Result<EdsFile> read_eds(std::string_view text, std::string_view file);

/// `gsd600.eds:12:9: error: …`, the form that compilers use and editors understand.
std::string to_string(const Diagnostic& diagnostic, std::string_view file);

}  // namespace servoctl::od
