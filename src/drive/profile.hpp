#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "drive/fault.hpp"
#include "drive/rules.hpp"
#include "od/dictionary.hpp"
#include "od/eds.hpp"
#include "od/parameter.hpp"

namespace servoctl::drive {

/// The family whose files say what CiA 301 and CiA 402 say of every drive.
inline constexpr std::string_view kGenericFamily = "cia402";

/// All that is known of one drive family: its dictionary, panel parameters, faults and rules.
struct Profile {
  std::string family;                  ///< `gsd600`; the path for a file of the user's own.
  std::vector<std::string> ancestors;  ///< Its parent, the parent of that, and so on.
  Rules rules;
  od::Dictionary dictionary;
  std::vector<od::Parameter> parameters;
  bool made_of_dictionary = false;  ///< There is no table of parameters: see maker_parameters().
  std::vector<Fault> faults;
  /// Where it has a table of its own those of its parents, or of CiA 402: what codes mean that it does not
  /// list.
  std::vector<Fault> parent_faults;
  std::vector<std::string> warnings;  ///< Findings in the files that did not stop them from being used.
  bool of_file = false;               ///< A file of the user's own, not a family by its name.
  /// The EDS, DCF or ESI the dictionary comes from, as for od::sheet_name(); empty: none.
  std::filesystem::path data_sheet;
  /// Of a sheet that was learned (od::EdsFile::learned): what is `ro` in it and in no standard.
  std::set<ObjectAddress> unknown_access;
  std::vector<od::EntryNote> notes;  ///< What a DCF says of its entries, in rising address.
  std::uint8_t configured_node = 0;  ///< That a DCF is the configuration of; 0: none.
  /// Its file of topics and those of its parents, the nearest first: load_topics() reads them.
  std::vector<std::filesystem::path> topic_files;

  /// The parameter with this id, in any of the ways people write it (`Pn0202`, `pn202`).
  const od::Parameter* parameter(std::string_view id) const;
  /// The parameter of this object.
  const od::Parameter* parameter(ObjectAddress object) const;

  /// What its parents, or CiA 402, say of a code that it does not list itself; null for nothing.
  const Fault* parent_fault(std::uint16_t code) const;

  /// The rules are those of CiA 301 and 402 alone: what this drive does otherwise is not known.
  bool is_generic() const;

  /// Whether it is this family or descends from it.
  bool descends_from(std::string_view other) const;

  /// Builds the tables behind parameter(), and the parameters of a dictionary that comes without a table of
  /// them; called by load_profile().
  void build_index();

 private:
  std::unordered_map<std::string, std::size_t> by_id_;
  std::unordered_map<ObjectAddress, std::size_t> by_object_;
};

/// Where families are looked for, in this order: the folders of $SERVOCTL_DRIVES (separated by `:`), the
/// user's own
/// (`$XDG_CONFIG_HOME/servoctl/drives`, `~/.config/servoctl/drives`), the data installed with the program or
/// in its source tree.
std::vector<std::filesystem::path> drive_folders();

/// The folders of a program: drive_folders(), looked for when they are first asked for (most lines never do),
/// or others that are given to it.
class Folders {
 public:
  Folders() = default;
  // NOLINTBEGIN(google-explicit-constructor): used wherever folders are.
  Folders(std::vector<std::filesystem::path> given) : given_(std::move(given)) {}
  Folders(std::initializer_list<std::filesystem::path> given) : given_(given) {}
  operator std::span<const std::filesystem::path>() const;
  // NOLINTEND(google-explicit-constructor)

 private:
  std::optional<std::vector<std::filesystem::path>> given_;
};

/// A family that was found: its name and its files without extension.
struct Family {
  std::string name;
  std::filesystem::path stem;  ///< `…/eds/vmmore/gsd600`
};

/// All families in the folders and one level below, by name; the first folder that has one wins. Reads no
/// file.
std::vector<Family> find_families(std::span<const std::filesystem::path> folders);

/// The one of this name, in any case of its letters; null for none.
const Family* find_family(std::span<const Family> families, std::string_view name);

/// Loads a family by name, or a user's own `.eds`, `.dcf`, `.xml` (of several devices one: `.xml#2`), `.csv`
/// or
/// `.toml` file by path (a `.toml` with the files of the same name beside it). What its parent says holds
/// where it says nothing itself. Errc::usage for an unknown name (nearest ones offered), Errc::file for a
/// file that cannot be used.
Result<Profile> load_profile(std::string_view family, std::span<const std::filesystem::path> folders);
/// The same of a family that was found.
Result<Profile> load_profile(const Family& family, std::span<const std::filesystem::path> folders);

/// What a data sheet that is in no file says (a drive's own dictionary), on what CiA 402 says of all
/// drives.
Profile profile_of_sheet(od::EdsFile sheet, std::string name, std::span<const std::filesystem::path> folders);

/// The `.toml` of a family.
std::filesystem::path rules_file(const Family& family);
/// Only the rules of a family, for recognising drives.
Result<Rules> load_rules(const Family& family);

}  // namespace servoctl::drive
