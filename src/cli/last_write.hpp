#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/settings.hpp"
#include "command/command.hpp"
#include "session/identity.hpp"

namespace servoctl::cli {

/// What the last line of `param set` or `write` replaced in drives, and by what, so that it can be put back.
/// Reads the values before the line and after it, and the identity of each drive once; writes nothing.
class LastWrite {
 public:
  struct Value {
    std::uint8_t node = 0;
    std::string target;  ///< What the node is called after -n: its number, or the axis.
    std::string name;    ///< Of the object, as it was typed.
    std::string shown;   ///< Of the object, as people know it.
    ObjectAddress object;
    std::string type;  ///< As after --type; empty where the dictionary says it.
    Bytes before;
    Bytes after;
    std::string before_text;  ///< Reads as that value in a line that writes it.
    std::string after_text;
    std::string before_shown;  ///< As people read it, with its unit.
    std::string after_shown;
    session::Identity identity;
    std::uint64_t opening = 0;  ///< Of the bus, as BusHolder::opening().
    std::uint32_t boots = 0;    ///< Of the node since then, when it was written.
  };
  /// Of one line.
  struct Line {
    std::string command;  ///< `param set` or `write`.
    std::string bus;
    std::string place;        ///< The nodes that the prompt had in use.
    std::string drive;        ///< Family as after -d; empty: none was named.
    bool by_axis = false;     ///< Its axes were named, by the line or by `use`: they say bus and family.
    bool of_cabinet = false;  ///< Settings::of_cabinet.
    show::AxisNames names;    ///< Settings::names.
    bool keep = false;        ///< --keep was given.
    bool unlock = false;      ///< --unlock was given.
    bool turned = false;      ///< `undo` wrote it: to put it back brings the newer values again.
    std::vector<Value> values;
    std::string why_not;  ///< Why it is not put back; empty: it can be.
  };

  /// Whether lines are looked at.
  void set_enabled(bool enabled) { enabled_ = enabled; }
  /// The nodes of lines that name none.
  void set_place(std::string nodes) { place_ = std::move(nodes); }
  /// Before a line that the context is ready for; `opening` of its bus as BusHolder::opening().
  void look(const command::Command& command, const command::Arguments& arguments,
            const command::Context& context, const Settings& settings, std::uint64_t opening);
  /// Behind it: what it changed is the last write from now on. A line that changed nothing leaves the one
  /// before.
  void settle(const command::Context& context);

  /// Null where nothing was written.
  const Line* line() const { return line_ ? &*line_ : nullptr; }
  /// What was put back is the last write, the other way round.
  void turn_round(Line line);
  /// What is still to be put back of a line.
  void keep(Line line);
  /// The last line wrote, and cannot be put back.
  void give_up(const command::Command& command, std::string why);

 private:
  void look_at(const command::Context& context, const settings::NamedValue& named, std::uint8_t node);
  const session::Identity* identity_of(session::Session& session, std::uint8_t node);

  bool enabled_ = false;
  std::string place_;
  std::optional<Line> pending_;
  std::optional<Line> line_;
  std::uint64_t opening_ = 0;  ///< Of the bus of the present line.
  /// By opening of the bus, node and restarts since.
  std::map<std::tuple<std::uint64_t, std::uint8_t, std::uint32_t>, session::Identity> identities_;
};

class Shell;

/// `undo`: puts back what the last write replaced, after a question. Nothing is sent, Errc::refused, when the
/// prompt is elsewhere now, or the drive is another one, has restarted, or no longer holds what was written.
/// What is left when one of several values fails is the last write from then on. `yes`: without questions.
/// The answer is the exit code.
int undo(Shell& shell, bool yes);

}  // namespace servoctl::cli
