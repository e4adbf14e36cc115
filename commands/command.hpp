#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commands/keys.hpp"
#include "drive/profile.hpp"
#include "report/value.hpp"
#include "session/session.hpp"

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
/// (Context::hold_family).
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

struct Command;

/// A line of a batch file that is read and not run.
struct BatchLine {
  std::uint32_t line = 0;  ///< Of the file, from 1.
  const Command* command = nullptr;
  Arguments arguments;
  std::vector<std::uint8_t> nodes;  ///< That the file names for this line; empty: it does not say.
  std::string family;               ///< The same.
};

/// What a command works with and where it leaves what it has to tell beside its result.
struct Context {
  session::Session* session = nullptr;  ///< Set when the command needs a bus.
  const drive::Profile* profile =
      nullptr;  ///< Set when a family was named; always when it needs a dictionary.
  std::span<const std::filesystem::path> drive_folders;
  std::filesystem::path state_folder;  ///< For records of changes under way; empty: none are kept.
  std::vector<std::uint8_t> nodes;     ///< Set when the command needs a node; 0 stands for all.
  bool nodes_typed = false;            ///< In the line itself; else by `use` or the environment.
  bool chinese = false;                ///< Names in Chinese where there are any.
  bool read_only = false;              ///< Nothing in a drive may be changed.
  bool dry_run = false;                ///< Show what would be sent, send nothing.
  bool stays_open = false;             ///< Other lines follow on the same session: a prompt, a batch file.
  /// Asks before something that stores, resets, re-addresses or moves; Errc::refused when the answer is no.
  std::function<Result<void>(std::string_view question)> confirm;
  /// Shows one sample of a command that goes on: the line in text, the record with `-o jsonl`. With `--json`
  /// nothing: the result has to carry the samples.
  std::function<void(const report::Record& sample, std::string_view line)> emit;

  /// Shows lines at once where people look (stderr), whatever form the result has; may be empty.
  std::function<void(std::string_view text)> tell;
  /// Whether what emit() shows reaches nobody any more (closed pipe, full disk); may be empty.
  std::function<bool()> output_lost;
  /// The keys of the terminal, until the answer is destroyed; null where there is none. May be empty.
  std::function<std::unique_ptr<Keys>()> open_keys;
  /// Opens the bus for a command whose words decide whether it needs one; sets `session`.
  std::function<Result<session::Session*>()> open_bus;
  /// Holds a family against the identity of these nodes, for a command whose words name them; `changes`: it
  /// will write to them. Errc::refused when they contradict it, or two nodes have one number. May be empty.
  std::function<Result<void>(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                             bool changes)>
      hold_family;
  /// The data of a family, loaded once; errors as load_profile().
  std::function<Result<const drive::Profile*>(const std::string& family)> family;
  /// Takes a batch file apart into its command lines, loops unrolled. Errc::file with the line of the first
  /// that is wrong, or is no command.
  std::function<Result<std::vector<BatchLine>>(std::string_view text, const std::string& file)> batch_lines;

  bool keeps_samples = false;  ///< `--json`: the result carries what emit() was given.
  bool wants_records = false;  ///< `-o jsonl`: samples are shown as records, one document a line.
  /// Shows many samples at once, rendered already, for commands to which emit() is too slow; see
  /// SampleWriter.
  std::function<void(std::string_view lines)> write;

  std::vector<Error>
      errors;  ///< Parts that failed while others succeeded; the first one makes the exit code.
  std::vector<std::string> notices;  ///< Things worth knowing that are no errors.
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
