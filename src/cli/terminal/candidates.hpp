#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "canopen/pdo.hpp"
#include "cli/shell.hpp"
#include "cli/terminal/begun_place.hpp"
#include "cli/terminal/candidate_list.hpp"
#include "command/command.hpp"

namespace servoctl::cli {

/// What may stand in the place of a word that was begun: names from the registry, from the data of the
/// family, from the bus as it was heard, and from the disk. Nothing is asked of a drive.
class Candidates {
 public:
  Candidates(std::string begun, Shell& shell, BegunPlace place);

  /// From now on objects and parameters are taken that have the word anywhere in their name.
  void match_inside() { inside_ = true; }
  /// Of what is added from now on; the answer is the one before.
  Candidate::Group begin_group(Candidate::Group group) { return std::exchange(group_, group); }
  /// Taken where it begins as the word does, ASCII case ignored.
  void add(std::string_view word, std::string_view hint = {});
  void add_commands(const std::vector<std::string>& words, std::size_t first);
  void add_families();
  void add_buses();
  /// Nodes that were heard or spoken to, or are simulated, and axes of the cabinet; of a list its last part.
  void add_nodes();
  void add_axes();
  /// All, or those that end so; folders end with a slash.
  void add_files(std::span<const std::string_view> endings = {});
  /// What the parameter of a command may be; `before`: the words of the same parameter before this one.
  void add_values(const command::Command* command, const command::Parameter& parameter,
                  const std::vector<std::string>& before);
  /// What the object or panel parameter may be set to: its labels, or the number that was begun in units.
  void add_values_of(std::string_view object);

  /// For what follows the first bytes of the word, as behind `--bus=`.
  Candidates behind(std::size_t bytes) const;
  /// Puts these bytes of the word before each of `value`, and takes them.
  void take_behind(std::size_t bytes, Candidates value);

  /// What may stand there, in words; empty where the candidates say it.
  std::string note() const { return told(note_); }
  /// In a shell: any file may stand there, and the shell knows them.
  bool any_file() const { return any_file_; }
  /// What they are told of is in the language of who reads.
  std::vector<Candidate> take();

 private:
  const drive::Profile* profile();
  bool may_stand(const od::Entry& entry) const;
  std::string told(const std::string& english) const;
  bool fits(std::string_view word) const;
  void add_kind(const command::Command* command, const command::Parameter& parameter,
                const std::vector<std::string>& before);
  void add_objects();
  void add_addresses();
  void add_panel_parameters(bool also_placed);
  void add_assignment(const std::vector<std::string>& before);
  void add_topics(const std::vector<std::string>& before);
  void add_cells(std::size_t begin);
  void add_durations();
  void add_node_numbers();
  std::string list_before() const;
  void add_units(std::string_view of);
  void add_motion_units(std::string_view object, std::span<const char* const> units);
  void add_words_of(const command::Command& command, const command::Parameter& parameter);
  void add_known_word(const command::Command& command, const command::Parameter& parameter);
  std::string heard_of(std::uint8_t node);
  std::map<std::uint8_t, std::string> known_nodes();

  std::string begun_;
  Shell* shell_;
  BegunPlace place_;
  bool chinese_;
  std::unordered_set<std::string> known_;
  std::vector<Candidate> out_;
  std::optional<canopen::PdoDirection> mapped_;  ///< Objects are for a PDO of this direction.
  Candidate::Group group_ = Candidate::Group::values;
  std::string note_;
  bool any_file_ = false;
  bool inside_ = false;
};

}  // namespace servoctl::cli
