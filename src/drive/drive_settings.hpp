#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "drive/profile.hpp"

namespace servoctl::drive {

/// One entry that can be written or may be, and why it is no setting to be kept; `left_out` is empty when it
/// is one.
struct DriveSetting {
  const od::Entry* entry = nullptr;
  const od::Parameter* parameter = nullptr;
  std::string_view left_out;  ///< `write-only`, `command`, `volatile`, `process data`, `domain`,
                              ///< `memory switch`, `password`
  /// False: is_access_unknown(). It is saved and compared, and never written.
  bool is_writable = true;
};

/// Whether an entry is `ro` only because nobody knows whether it can be written: its data sheet was learned
/// by reading index by index (od::EdsFile::learned), the standard does not say `ro`, and no table of the
/// manual does.
bool is_access_unknown(const Profile& profile, const od::Entry& entry);

/// What is written for the sake of other writes, and its name: the `memory switch` that says where values go,
/// the `password` that opens the lock. Part of a restore they would send the rest of it elsewhere.
std::vector<std::pair<ObjectAddress, std::string_view>> means_of_writing(const Profile& profile);

/// Everything of a drive that can be written, and what is_access_unknown(), in rising address.
/// What moves the drive (controlword, targets, offsets, outputs), what is read off it, what starts an action,
/// and what chooses the memory or opens the lock for the writes themselves are no settings.
std::vector<DriveSetting> settings_of(const Profile& profile);

/// Whether the object says which PDOs are exchanged, when, and what is in them: communication and mapping
/// records (1400h to 1BFFh), what assigns them (PdoRules::assign_rpdo, assign_tpdo), and the parameters in
/// which the drive stores them (od::Parameter::mirror).
bool is_of_pdos(const Profile& profile, ObjectAddress object);

}  // namespace servoctl::drive
