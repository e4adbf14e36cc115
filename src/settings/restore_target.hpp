#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "session/restore.hpp"
#include "session/scan.hpp"
#include "settings/backup_file.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// What of a backup goes into a drive.
struct RestoreChoice {
  bool with_address = false;  ///< Node-ID and bitrate as well.
  bool force = false;         ///< Although identity or family are others; what does not fit is left out.
  bool skip_invalid = false;  ///< Values that the drive cannot take are named and left out.
  bool keep = false;          ///< They are to survive power-off.
  bool only_looks = false;    ///< Nothing will be written: that the drive is energised is no hindrance.
  session::Values before{};   ///< Old values of the restore that this one continues.
};

/// A drive that a backup is to go into: whether it may, and which values. Writes nothing.
class RestoreTarget {
 public:
  /// `desk` and `backup` outlive it. `title` names the backup in messages.
  RestoreTarget(show::Desk& desk, const Backup& backup, Message title, std::uint8_t node,
                const RestoreChoice& choice)
      : desk_(&desk), backup_(&backup), title_(std::move(title)), node_(node), choice_(choice) {}

  /// Checks family, identity and standstill, reads what the drive holds, and checks every value against its
  /// data. Errc::refused for another or an energised drive, for what is no setting of this one, for a COB-ID
  /// that no drive may have, and for PDOs that `pdo map` and `pdo enable` would refuse; Errc::negative, with
  /// line and entry, for a value that this drive cannot take.
  Result<void> prepare();
  /// Part of it, to be asked again where somebody took their time: Errc::refused for an energised drive.
  Result<void> check_standstill() const;

  const session::Identity& identity() const { return identity_; }
  const session::Values& wanted() const { return wanted_; }
  /// The same without the COB-IDs that are not of the backup: their PDOs are only made invalid for a while.
  const session::Values& asked() const { return asked_; }
  const session::Values& present() const { return present_; }
  /// What differs and is not sent, and why: values of a backup of ours that are outside of the family's
  /// limits, and all those together of which nobody knows whether they can be written
  /// (drive::is_access_unknown()). They are not among wanted().
  const std::vector<Error>& left() const { return left_; }
  std::size_t left_count() const { return left_count_; }
  /// How many of wanted() the drive holds otherwise.
  std::size_t to_write() const;
  /// wanted() and present() with all that is compared and not sent.
  session::Values wanted_and_left() const;
  session::Values present_and_left() const;
  /// Whether node-ID or bitrate of the backup is another, and not wanted.
  bool keeps_address() const { return keeps_address_; }

 private:
  Result<void> check_identity();
  Result<void> check_at_rest() const;
  bool is_out_of_reach(const Backup::Entry& entry);
  /// Modbus: 0 calls all of a line, and none answers to it.
  Result<void> check_line_address(const Backup::Entry& entry) const;
  bool is_own_address(ObjectAddress object) const;
  Result<void> leave_out(const Backup::Entry& entry, std::string_view reason);
  Result<void> choose_values();
  void tell_kept() const;
  void add_copies(const std::map<ObjectAddress, std::string_view>& settings);
  Result<void> read_present();
  Result<void> compare_undecided();
  bool same_length(ObjectAddress object, const Bytes& data) const;
  std::uint32_t line_of(ObjectAddress object) const;
  Result<void> check_values();
  Result<void> check_each(bool copies);
  Result<void> check_value(ObjectAddress object, const Bytes& data, bool& outside) const;
  Result<void> check_pdos();
  Message place_of(ObjectAddress object) const;
  tl::unexpected<Error> unfit(Errc code, ObjectAddress object, const Message& what, Message hint) const;

  show::Desk* desk_;
  const Backup* backup_;
  Message title_;
  std::uint8_t node_;
  RestoreChoice choice_;
  session::Identity identity_;
  session::Values wanted_;
  session::Values asked_;
  session::Values present_;
  std::map<ObjectAddress, ObjectAddress> copies_;  ///< Added to wanted_ for what is to be kept, and of what.
  std::vector<Error> left_;
  std::size_t left_count_ = 0;
  session::Values unsent_wanted_;  ///< Outside of the limits, or not known to be writable.
  session::Values unsent_present_;
  bool keeps_address_ = false;
  std::size_t unreachable_ = 0;  ///< Values without a Modbus register, where it is reached over Modbus.
};

}  // namespace servoctl::settings
