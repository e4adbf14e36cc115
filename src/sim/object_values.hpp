#pragma once

#include <cstdint>
#include <unordered_map>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::sim {

/// Whether an index is of the communication profile area (CiA 301, table 38).
inline bool in_communication_area(std::uint16_t index) { return index >= 0x1000 && index < 0x2000; }

/// The values of all entries of a drive, as bytes, with the checks a drive makes before it takes a new one:
/// existence, access, length and limits. Rules that depend on the drive's state are made by the drive.
class ObjectValues {
 public:
  explicit ObjectValues(const drive::Profile& profile) : profile_(&profile) {}

  /// Every entry goes to its default for this node; one without a default to zero.
  void load_defaults(std::uint8_t node);
  /// The same for the communication profile area (1000h to 1FFFh) alone.
  void load_communication_defaults(std::uint8_t node);

  /// Abort code when the entry cannot be read, or 0.
  std::uint32_t check_read(ObjectAddress object) const;
  /// Abort code when the entry cannot be written, whatever the data, or 0.
  std::uint32_t check_writable(ObjectAddress object) const;
  /// Abort code when the entry does not take these bytes, or 0.
  std::uint32_t check_write(ObjectAddress object, ByteSpan data, std::uint8_t node) const;

  /// From now on what takes effect by a restart is in force as it is.
  void start();
  /// Until release() the value that this one has now stays in force, whatever is written.
  void hold(ObjectAddress object) { held_.try_emplace(object, get(object)); }
  void release();

  const Bytes& get(ObjectAddress object) const;
  /// As get(); of what takes effect by a restart, what it was at start(), and of what is held, at hold().
  const Bytes& in_force(ObjectAddress object) const;
  std::uint64_t number(ObjectAddress object) const { return load_le(get(object)); }
  void set(ObjectAddress object, ByteSpan data) {
    values_[object].assign(data.begin(), data.end());
    ++changes_;
  }
  /// Sets a number in the size the entry has.
  void set_number(ObjectAddress object, std::uint64_t value);
  /// The highest sub-index the object has; 0 for one that does not exist.
  std::uint8_t last_sub(std::uint16_t index) const;
  /// Grows whenever a value is set.
  std::uint64_t changes() const { return changes_; }
  bool has(ObjectAddress object) const { return profile_->dictionary.find(object) != nullptr; }

 private:
  std::uint32_t supported_modes() const;
  void load_default(const od::Entry& entry, std::uint8_t node);
  void load_identity();

  const drive::Profile* profile_;
  std::unordered_map<ObjectAddress, Bytes> values_;
  std::unordered_map<ObjectAddress, Bytes> at_start_;  ///< What takes effect by a restart.
  std::unordered_map<ObjectAddress, Bytes> held_;
  std::uint64_t changes_ = 0;
};

}  // namespace servoctl::sim
