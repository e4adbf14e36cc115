#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/result.hpp"
#include "od/eds.hpp"
#include "show/desk.hpp"

/// A data sheet (EDS, DCF, ESI) compared with the dictionary of a live drive.
namespace servoctl::settings {

enum class Difference : std::uint8_t {
  missing,        ///< The file lists it; the drive has no such object or sub-index.
  unlisted,       ///< The drive has it; the file does not list it.
  type,           ///< The bytes cannot be of this type, or the drive describes another one.
  size,           ///< The drive has another number of bytes.
  access,         ///< It cannot be read as the file says; or it can, and the file denies it.
  default_value,  ///< A constant of another value; with `factory` also a setting.
  limits,         ///< The value is outside LowLimit and HighLimit.
  no_answer,      ///< This object alone is not answered properly.
};
std::string_view name(
    Difference difference);  ///< `missing unlisted type size access default limits no-answer`

struct DictionaryFinding {
  ObjectAddress object;
  std::string name;
  Difference difference = Difference::missing;
  std::string file;   ///< What the file says: `u16`, `rw`, a value; empty: nothing.
  std::string drive;  ///< What the drive has; empty: nothing.
};

/// An entry about which nothing was found out.
struct UncheckedEntry {
  ObjectAddress object;
  std::string name;
  std::string reason;
  bool is_empty = false;  ///< It holds nothing now (abort 0800 0024h), as an error history without errors.
};

struct DictionaryCheck {
  std::uint8_t node = 0;
  std::size_t entries = 0;      ///< Of the file.
  std::size_t answered = 0;     ///< Of these, whose value was read.
  std::size_t probed = 0;       ///< Objects that the file does not list and that were asked for.
  std::size_t not_default = 0;  ///< Settings with another value than the default, where no finding.
  std::vector<DictionaryFinding> findings;  ///< In rising address.
  std::vector<UncheckedEntry> unchecked;
  std::map<ObjectAddress, Bytes> values = {};  ///< What was read.
};

struct CheckOptions {
  bool listed_only = false;  ///< Objects that the file does not list are not asked for.
  bool factory = false;      ///< The drive is at its factory values: another one than the default counts.
};

/// Reads every entry of the file that can be read, and of what it does not list what a drive is likely to
/// have. On EtherCAT the drive's own description says that, and types and access as well (SDO information).
/// Nothing is asked for that raises an alarm on the drive (session::access_alarm()); while the drive is
/// enabled, nothing that the file does not list. Errc::timeout if the drive no longer answers, Errc::refused
/// after an EMCY, Errc::bus, Errc::interrupted. What people should know goes to the notices of the desk.
Result<DictionaryCheck> check_dictionary(show::Desk& desk, std::uint8_t node, const od::EdsFile& file,
                                         const CheckOptions& options);

/// Compares what was read of an entry with what the file says of it.
class EntryJudge {
 public:
  EntryJudge(DictionaryCheck& out, const show::Desk& desk, std::uint8_t node, const CheckOptions& options)
      : out_(&out), desk_(&desk), node_(node), options_(options) {}

  /// The answers are always of four bytes, or do not tell their size: a shorter object cannot be told.
  void doubt_sizes() { doubts_sizes_ = true; }
  void judge(const od::Object& object, const od::Entry& entry, const Result<Bytes>& answer);
  void add(const od::Object& object, const od::Entry& entry, Difference difference, std::string file,
           std::string drive);
  /// Nothing was found out about it.
  void leave(const od::Object& object, const od::Entry& entry, std::string reason, bool is_empty = false);

 private:
  bool is_unfilled(ObjectAddress address) const;
  void judge_refusal(const od::Object& object, const od::Entry& entry, const Error& refusal);
  void judge_bytes(const od::Object& object, const od::Entry& entry, Bytes bytes);
  void judge_value(const od::Object& object, const od::Entry& entry, const Bytes& bytes);
  void judge_default(const od::Object& object, const od::Entry& entry, const od::Value& value);

  DictionaryCheck* out_;
  const show::Desk* desk_;
  std::uint8_t node_;
  CheckOptions options_;
  bool doubts_sizes_ = false;
};

/// `Homing speeds, speed during search for zero`: of an entry beside others the object as well. In Chinese
/// for a desk that has the names so, where the family or the standard has the name.
std::string full_name(const show::Desk& desk, const od::Object& object, const od::Entry& entry);
std::string size_text(std::size_t size);  ///< `2 bytes`

}  // namespace servoctl::settings
