#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "command/front_end.hpp"
#include "report/value.hpp"
#include "settings/setting_line.hpp"
#include "show/desk.hpp"

namespace servoctl::commands {

/// What a word of the command line stands for. Decides how it is completed and described, not how it is
/// parsed: every value reaches the command as text.
enum class Kind : std::uint8_t {
  flag,
  text,
  number,
  duration,
  value,
  type,
  object,
  parameter,
  nodes,
  family,
  bus,
  file,
  choice,
  command
};

/// One option or positional word of a command.
struct Parameter {
  std::string_view name;  ///< `--type` is an option, `object` a positional word.
  std::string_view help;
  Kind kind = Kind::text;
  bool required = false;
  bool many = false;  ///< Takes all words that follow.
  std::span<const std::string_view> choices = {};
  std::string_view short_name = {};  ///< `-n`
  bool repeats = false;              ///< An option that may be given several times, one value each.
};

/// What must be there before the command runs; the front end sees to it, not the command. Combined with `|`.
enum class Needs : std::uint8_t { nothing = 0, dictionary = 1, bus = 2, node = 6 };  // A node needs a bus.
constexpr Needs operator|(Needs a, Needs b) {
  return static_cast<Needs>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr bool includes(Needs all, Needs part) {
  return (static_cast<std::uint8_t>(all) & static_cast<std::uint8_t>(part)) ==
         static_cast<std::uint8_t>(part);
}

/// What the command may do to a drive. From `stores` on it asks on a terminal and needs --yes elsewhere; from
/// `writes` on
/// --read-only refuses it.
enum class Effect : std::uint8_t { none, reads, writes, stores, resets, moves };

/// When the family that was named is held against what the drives say they are, before anything is sent.
/// `by_effect`: before what changes something; `always`: before an answer, too, that makes sense for the
/// family alone; `never`: a way out, which nothing may refuse, or the command sees to it
/// (Context::hold_family()).
enum class FamilyCheck : std::uint8_t { by_effect, always, never };

/// The words of one command line, by parameter name.
class Arguments {
 public:
  void add(std::string_view name, std::string value) {
    values_[std::string(name)].push_back(std::move(value));
  }
  bool has(std::string_view name) const { return values_.find(name) != values_.end(); }
  /// The only or first value; empty when there is none.
  std::string_view text(std::string_view name) const;
  std::span<const std::string> all(std::string_view name) const;

 private:
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

/// The desk of one command line: with what its words and the front end add.
struct Context : show::Desk {
  std::span<const std::filesystem::path> drive_folders;
  bool nodes_typed = false;  ///< In the line itself; else by `use` or the environment.
  bool read_only = false;    ///< Nothing in a drive may be changed.
  bool stays_open = false;   ///< Other lines follow on the same session: a prompt, a batch file.
  command::FrontEnd* front_end = nullptr;  ///< Null: there is none, and nothing is held.

  /// As FrontEnd::hold_family().
  Result<void> hold_family(std::span<const std::uint8_t> of, const drive::Profile* family,
                           bool changes) const {
    return front_end == nullptr ? Result<void>() : front_end->hold_family(of, family, changes);
  }
};

struct Command {
  std::string_view path;     ///< `param set`; lives in commands/param_set.cpp.
  std::string_view summary;  ///< One line, no full stop.
  std::string_view details;  ///< More for `help COMMAND`: what it does, what it answers, examples.
  std::span<const Parameter> parameters;
  Needs needs = Needs::nothing;
  Effect effect = Effect::none;
  FamilyCheck family = FamilyCheck::by_effect;
  std::string_view reads_without = {};  ///< Without this parameter it only reads, whatever `effect` says.
  Result<report::Value> (*run)(Context&, const Arguments&) = nullptr;
  /// Checks names and values by the dictionary alone (no session in the context), for lines that are to be
  /// run later; null: there is nothing to check.
  Result<void> (*check)(Context&, const Arguments&) = nullptr;
  /// The values it writes, for a batch file that is read as settings; null: it writes none.
  Result<std::vector<settings::NamedValue>> (*settings)(const Arguments&) = nullptr;
  bool of_front_end = false;  ///< It runs other command lines: the front end does it, `run` is null.

  /// What it does with these arguments.
  Effect effect_with(const Arguments& arguments) const {
    return !reads_without.empty() && !arguments.has(reads_without) ? Effect::reads : effect;
  }
};

/// All commands in the order of `help`.
std::span<const Command* const> registry();

/// The command of this exact path, or null.
const Command* find_command(std::string_view path);

/// Options every command understands.
std::span<const Parameter> global_options();

}  // namespace servoctl::commands
