#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "cli/shell.hpp"
#include "cli/terminal/candidate_list.hpp"
#include "command/command.hpp"

namespace servoctl::cli {

/// What may stand in the place of a word that was begun: names from the registry, from the data of the
/// family, from the bus as it was heard, and from the disk. Nothing is asked of a drive.
class Candidates {
 public:
  /// `family`: as after -d; empty: none.
  Candidates(std::string begun, Shell& shell, std::string family);

  /// Taken where it begins as the word does, ASCII case ignored.
  void add(std::string_view word, std::string_view hint = {});
  void add_commands(const std::vector<std::string>& words, std::size_t first);
  void add_families();
  void add_buses();
  /// Nodes that were heard or spoken to, and axes of the cabinet; of a list its last part.
  void add_nodes();
  /// What the parameter of a command may be; `before`: the words of the same parameter before this one.
  void add_values(const command::Command* command, const command::Parameter& parameter,
                  const std::vector<std::string>& before);
  /// What the object or panel parameter may be set to: its labels, or the number that was begun in units.
  void add_values_of(std::string_view object);

  /// What may stand there, in words; empty where the candidates say it.
  const std::string& note() const { return note_; }
  std::vector<Candidate> take() { return std::move(out_); }

 private:
  const drive::Profile* profile();
  bool fits(std::string_view word) const;
  void add_objects();
  void add_addresses();
  void add_panel_parameters();
  void add_assignment(const std::vector<std::string>& before);
  void add_topics(const std::vector<std::string>& before);
  void add_files();
  void add_units(std::string_view of);
  void add_known_word(const command::Command& command, const command::Parameter& parameter);
  std::string heard_of(std::uint8_t node);

  std::string begun_;
  Shell* shell_;
  std::string family_;
  bool chinese_;
  std::unordered_set<std::string> known_;
  std::vector<Candidate> out_;
  std::string note_;
};

}  // namespace servoctl::cli
