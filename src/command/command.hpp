#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "command/arguments.hpp"
#include "command/context.hpp"
#include "report/value.hpp"
#include "settings/setting_line.hpp"

namespace servoctl::command {

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
  command,
  topic
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
/// A node and a kind of network need a bus; `can`: frames, COB-IDs or SYNC; `nmt`: NMT
/// commands, by CAN or a gateway of CiA 309-3; `ethercat`: AL states.
enum class Needs : std::uint8_t {
  nothing = 0,
  dictionary = 1,
  bus = 2,
  node = 6,
  can = 10,
  ethercat = 18,
  nmt = 34
};
constexpr Needs operator|(Needs a, Needs b) {
  return static_cast<Needs>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr bool includes(Needs all, Needs part) {
  return (static_cast<std::uint8_t>(all) & static_cast<std::uint8_t>(part)) ==
         static_cast<std::uint8_t>(part);
}

/// What the command may do to a drive. From `stores` on it asks on a terminal and needs --yes elsewhere; from
/// `links` on --read-only refuses it. `links`: changes no drive but an interface of this machine, which
/// others may use, so that a whole bus may stand still; it asks where it stops one.
enum class Effect : std::uint8_t { none, reads, links, writes, stores, resets, moves };

/// When the family that was named is held against what the drives say they are, before anything is sent.
/// `by_effect`: before what changes something; `always`: before an answer, too, that makes sense for the
/// family alone; `never`: a way out, which nothing may refuse, or the command sees to it
/// (Context::hold_family()).
enum class FamilyCheck : std::uint8_t { by_effect, always, never };

/// A command line, and what it is for. The letters themselves and no pointers to them: nothing is to be
/// relocated when the program starts.
struct Example {
  char line[77];  ///< As at the prompt: without the word `servoctl`.
  char what[83];  ///< Begins in lower case, no full stop.
};

struct Command {
  std::string_view path;     ///< `param set`; lives in commands/param_set.cpp.
  std::string_view summary;  ///< One line, no full stop.
  std::string_view details;  ///< More for `help COMMAND`: what it does, what it answers.
  std::span<const Parameter> parameters;
  std::span<const Example> examples = {};  ///< One to three: what is needed most.
  Needs needs = Needs::nothing;
  Effect effect = Effect::none;
  FamilyCheck family = FamilyCheck::by_effect;
  bool standard_without = false;      ///< Without a family it is about the objects of the standards.
  std::string_view families_in = {};  ///< The file of this parameter may name the families: then -d need not.
  bool family_by_node = false;        ///< `-d 3=gsd600,4=da200` names a family for each node.
  std::string_view reads_without = {};  ///< Without this parameter it only reads, whatever `effect` says.
  Result<report::Value> (*run)(Context&, const Arguments&) = nullptr;
  /// Checks names and values by the dictionary alone (no session in the context), for lines that are to be
  /// run later; null: there is nothing to check.
  Result<void> (*check)(Context&, const Arguments&) = nullptr;
  /// The values it writes, for a batch file that is read as settings; null: it writes none.
  Result<std::vector<settings::NamedValue>> (*settings)(const Arguments&) = nullptr;
  bool to_all = false;  ///< Node 0 stays one message to all, and is not taken for those that answer.
  /// `-n all` stays node 0 on CAN: it goes to every node-ID, because a drive that answers nothing may have
  /// power.
  bool to_silent = false;
  bool way_out = false;       ///< Goes as far as it can, where some of its axes cannot take it.
  bool opens_bus = false;     ///< Its words decide which end of the bus it needs: it opens it itself.
  bool of_front_end = false;  ///< It runs other command lines: the front end does it, `run` is null.
  /// Scripts call it again and again: alone in its process it waits 2 ms for a second node of the same
  /// number, others 20.
  bool brief = false;
  bool goes_on = false;         ///< It shows what comes until it is ended: one bus and family at a time.
  bool all_by_default = false;  ///< Without -n in the line it is `-n all`, whatever is in use.
  /// The word or option that names a file it writes whole: a second bus or family would replace it.
  std::string_view one_file = {};
  bool joins = false;  ///< One run for all buses and families of a line: Context::others.
  /// It works where drives are known by registers alone (Modbus): without the objects of CiA 301 and CiA 402.
  bool on_registers = false;
  /// What there is instead of it on a network of another kind, for a hint; empty: nothing.
  std::string_view elsewhere = {};

  /// What it does with these arguments.
  Effect effect_with(const Arguments& arguments) const {
    return !reads_without.empty() && !arguments.has(reads_without) ? Effect::reads : effect;
  }
};

/// Options every command understands.
std::span<const Parameter> global_options();

}  // namespace servoctl::command
