#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/rehearsal.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// Sub-indexes of 1010h and 1011h (CiA 301, 7.5.2.13 and 7.5.2.14).
enum class ParameterGroup : std::uint8_t { all = 1, communication = 2, application = 3, vendor = 4 };

/// Whether values survive power-off.
enum class Kept : std::uint8_t { no, yes, unknown };

/// Whether the drives of the family can be told to keep their values: by 1010h, by settings of their own, or
/// by a switch between RAM and flash.
bool can_store(const drive::Profile& profile);
/// Whether the value of this object then survives power-off: by 1010h all do (CiA 301, 7.5.2.13); a switch or
/// a setting of the maker is stated for the maker's own parameters alone.
bool is_known_to_keep(const drive::Profile& profile, ObjectAddress object);

/// Longest wait for a drive that writes its flash or EEPROM; manuals name no time.
inline constexpr Duration kStorePatience = std::chrono::seconds(10);

/// What store_parameters() writes, in order; errors as there, but for what the drive says.
Result<std::vector<SdoRequest>> store_writes(const drive::Profile* profile, std::uint8_t node,
                                             ParameterGroup group);
/// The same for restore_defaults().
Result<std::vector<SdoRequest>> restore_writes(const drive::Profile* profile, std::uint8_t node,
                                               ParameterGroup group);

/// Makes the drive keep its present values: 1010h with "save", else the settings of the family's rules.
/// `profile` may be null. Errc::negative, with what can be done instead, where the family has no such way;
/// Errc::sdo_abort when the drive refuses.
Result<void> store_parameters(Session& session, const drive::Profile* profile, std::uint8_t node,
                              ParameterGroup group);

/// Makes the drive go back to its factory values: 1011h with "load", else the family's way. They are in force
/// after a restart. Errors as in store_parameters().
Result<void> restore_defaults(Session& session, const drive::Profile* profile, std::uint8_t node,
                              ParameterGroup group);

/// Writes to one node between open() and close(): where the family says, the password is given and taken
/// back, and values go to RAM or to flash as wanted. What was changed for it is put back on every way out.
class StorageScope {
 public:
  /// `profile` may be null: then nothing is known and nothing is done but 1010h.
  StorageScope(Session& session, const drive::Profile* profile, std::uint8_t node)
      : session_(&session), profile_(profile), node_(node) {}
  StorageScope(const StorageScope&) = delete;
  StorageScope& operator=(const StorageScope&) = delete;
  ~StorageScope() { (void)close(false, 0); }

  /// From now on nothing is written: what would be goes there, which outlives this.
  void rehearse(Rehearsal& rehearsal) { rehearsal_ = &rehearsal; }

  /// Before the writes. `choose` is false for writes that no memory is chosen for: the controlword, the
  /// communication objects, the switch itself. Errc::usage when `unlock` is wanted and the family has no
  /// password. After an error what had been changed is put back, or the message says that it is not.
  Result<void> open(bool keep, bool unlock, bool choose);
  /// After them. Stores only if `all_written`, and only if open() was asked to keep. `writes` is their
  /// number: where each wears the flash, it is told. The error says all that went wrong: values that are
  /// written but not kept, a password or a switch that could not be put back. By a switch each value is kept
  /// as it is written, whatever came of the others: `all_written` is of no matter then.
  Result<Kept> close(bool all_written, std::size_t writes);

  /// Whether the drive worked in its RAM before it was told to keep: what its flash holds may be older than
  /// what it answers, so a value that need not change must be written all the same.
  bool worked_in_ram() const { return keep_ && memory_.has_value(); }
  /// Before the values of a drive that worked in its RAM are put back: they are trials, and none of them
  /// belongs in the flash. Deaf to Ctrl-C. After an error the switch may still be at the flash; close() tries
  /// again.
  Result<void> leave_flash();

  /// What was done beside the writes, in words.
  const std::vector<Message>& notices() const { return notices_; }

 private:
  struct Changed {
    ObjectAddress object;
    Bytes before;
    Bytes now;
  };

  Result<void> prepare(bool unlock, bool choose);
  Result<void> set(const std::string& name, std::int64_t value, std::optional<Changed>& out);
  Result<void> put_back(std::optional<Changed>& changed);
  Result<void> choose_memory();
  Result<void> write(ObjectAddress object, const Bytes& data);
  Result<void> store_all();
  void tell_wear(std::size_t writes);
  void tell_memory(bool stays, std::size_t writes);

  Session* session_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  bool open_ = false;
  bool keep_ = false;
  std::optional<Changed> memory_;
  std::optional<Changed> password_;
  std::vector<Message> notices_;
  Rehearsal* rehearsal_ = nullptr;
};

}  // namespace servoctl::session
