#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/admission.hpp"
#include "cli/axis_lines.hpp"
#include "cli/bus_holder.hpp"
#include "cli/last_write.hpp"
#include "cli/outcome.hpp"
#include "cli/parse.hpp"
#include "cli/running_line.hpp"
#include "cli/settings.hpp"
#include "cli/terminal/console.hpp"
#include "cli/terminal/progress.hpp"
#include "session/session.hpp"
#include "show/known_drive.hpp"
#include "sim/sim_bus.hpp"

namespace servoctl::cli {

/// What holds for one line. Errors as apply_options().
Result<Settings> settings_of(const ParsedLine& line, const Settings& defaults);

/// Runs command lines, one after the other: opens what a command needs, runs it, renders its result. Keeps
/// the bus and the drive data open from one line to the next. Every front end runs its lines here.
class Shell {
 public:
  struct Options {
    Settings defaults;
    drive::Folders drive_folders;
    std::filesystem::path state_folder;  ///< As Context::state_folder.
    sim::SimBus::Clock clock = sim::SimBus::Clock::real_time;
    std::function<bool()> cancelled;
  };

  Shell(Console& console, Options options);
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  /// Runs one command line; the answer is the exit code.
  int run(const std::vector<std::string>& words);

  /// Runs one command line and shows nothing but the samples of a command that goes on. A line that names
  /// axes of several buses or families is run for one after the other, and has one outcome.
  Outcome perform(const std::vector<std::string>& words);

  /// Shows an error as `run` would; for front ends that fail before a command is known.
  int report_error(const Error& error, bool json, std::string_view command = {});

  Console& console() { return *console_; }
  /// Held while something is shown or asked, or what all lines share is used: a line may work on several
  /// buses at the same time, in a thread each.
  std::unique_lock<std::recursive_mutex> take_turn() { return std::unique_lock(turn_); }
  /// What goes on is shown no longer: something else is.
  void end_progress() { progress_.end(); }
  void show_progress(std::string_view line, TimePoint now) { progress_.update_line(line, now); }
  void show_share(double share, TimePoint begin, TimePoint now) { progress_.update_share(share, begin, now); }
  /// The line shows something of its own.
  void note_output() { progress_.note_output(); }
  /// While it lives a line is waited for, which is shown.
  class ShownWait {
   public:
    explicit ShownWait(Shell& shell) : progress_(&shell.progress_) { progress_->begin(); }
    ShownWait(const ShownWait&) = delete;
    ShownWait& operator=(const ShownWait&) = delete;
    ~ShownWait() {
      progress_->end();
      progress_->leave();
    }

   private:
    Progress* progress_;
  };
  /// Whether the user wants what is running to end.
  bool cancelled() const { return options_.cancelled && options_.cancelled(); }

  Settings& defaults() { return options_.defaults; }
  /// The bus as it is open now; null when none is.
  session::Session* session() { return bus_.session(); }
  /// All that are open.
  std::vector<session::Session*> sessions() const { return bus_.sessions(); }
  LastWrite& last_write() { return last_write_; }
  /// As BusHolder::heard_state(), on the bus of this URL; nothing where it is not open. `family`: empty where
  /// it is not known.
  HeardStates::State heard_state(std::string_view url, std::uint8_t node, const std::string& family);
  /// As BusHolder::opening().
  std::uint64_t opening(const session::Session& session) const { return bus_.opening(session); }
  /// The family of the lines that name none: that of the defaults, else what their one node was taken for;
  /// empty where that is open. Nothing is asked.
  std::string family_in_use() const;
  /// The same as people read it: `gsd600?` where it is a guess.
  std::string family_text() const;
  /// As BusHolder::lose(), of the bus that was used last.
  void lose_bus() {
    if (auto* session = bus_.session()) bus_.lose(*session);
  }
  /// As BusHolder::wait_for().
  bool wait_for(pollfd& wanted, Duration longest, const std::function<void(const Error&)>& lost) {
    return bus_.wait_for(wanted, longest, lost);
  }
  /// Whether other lines follow, so that what a line begins may go on behind it; the answer is what held
  /// before.
  bool stay_open(bool stays) { return std::exchange(stays_open_, stays); }
  bool stays_open() const { return stays_open_; }
  /// As CabinetHolder::search_once().
  void search_cabinet_once(bool once) { cabinet_.search_once(once); }
  /// Who reads the lines de-energises at the end what they enabled.
  void disable_at_end() { disables_at_end_ = true; }
  /// Many lines are read: a signal that comes at any time until close() makes their exit code that of an
  /// interruption. Of a single command only the command itself knows what Ctrl-C means.
  void end_interrupted_by_signal() { signal_interrupts_ = true; }
  session::Protection::Hold protect(session::Care care) { return {&protection_, care}; }
  std::vector<std::uint8_t> energised_on(std::string_view url) const { return bus_.energised_on(url); }
  bool has_adapter(std::string_view adapter) const { return bus_.has_adapter(adapter); }
  Result<void> release_adapter(std::string_view adapter) { return bus_.release_adapter(adapter); }
  bool produces_sync() const { return bus_.produces_sync(); }
  bool must_go_on() const { return bus_.must_go_on(); }
  /// Whether a drive was left energised.
  bool leaves_power() const { return bus_.leaves_power(); }
  /// As BusHolder::stop_sync().
  void stop_sync() { bus_.stop_sync(); }
  /// Stops and disables the drives that were left energised, and says so: for a prompt that ends, and a file
  /// that stops in the middle. A single `enable` is left as it is.
  void let_go() { bus_.let_go(); }
  /// Closes the bus. After a signal nothing that was energised here stays so. The exit code of the program:
  /// `code`, or that of what went wrong here, such as a drive that could not be de-energised.
  int close(int code);
  /// Where a drive stays energised only as long as servoctl is there: waits until the user ends it. The exit
  /// code: not 0 when it ended otherwise.
  int hold();

  /// As CabinetHolder::get().
  Result<const cabinet::Cabinet*> cabinet(const Settings& settings);
  /// What these nodes of the session's bus are taken for, for --verbose to name their objects.
  void note_family(const session::Session& session, std::span<const std::uint8_t> nodes,
                   const drive::Profile* profile);

  /// As parts_of(), with the cabinet file of the settings; none where there is no such file, or the line does
  /// not need it. Errors as there, and of the file.
  Result<std::vector<LinePart>> parts_of_line(const ParsedLine& line, const Settings& settings,
                                              std::vector<Message>& notices);
  /// What one line said, for the lines that follow: as settle_bus(), and what lost is told at once.
  Result<Settings> settings_for_lines(Settings settings);
  /// As with_axis_option().
  std::vector<std::string> name_axes(std::vector<std::string> words, const CommandMatch& match);

  /// The family's data, loaded once. Errors as load_profile().
  Result<const drive::Profile*> profile(const std::string& family);
  /// As BusHolder::open().
  Result<session::Session*> open(const Settings& settings);
  /// As BusHolder::open_ring_end().
  Result<std::unique_ptr<session::RingEnd>> open_ring_end(const Settings& settings);
  /// As BusHolder::open_register_end().
  Result<std::unique_ptr<session::RegisterEnd>> open_register_end(const Settings& settings);
  const drive::Folders& drive_folders() const { return options_.drive_folders; }
  const std::filesystem::path& state_folder() const { return options_.state_folder; }

  /// Lines about what nodes told since the last call.
  std::vector<Message> take_notices(const drive::Profile* profile, bool chinese);
  /// The same as notices on the console, by the family of the defaults.
  void tell_notices();

 private:
  struct Run {
    Run(Shell& shell, const command::Command& of, LinePart part)
        : command(&of),
          settings(std::move(part.settings)),
          axes(std::move(part.axes)),
          on_bus(std::move(part.on_bus)),
          line(shell, settings, context) {}
    const command::Command* command;
    Settings settings;
    std::vector<const cabinet::Axis*> axes;    ///< That the nodes are; empty where they are just nodes.
    std::vector<const cabinet::Axis*> on_bus;  ///< All that the cabinet file has on the bus.
    command::Context context;
    RunningLine line;
    bool family_found = false;  ///< The line does not name it.
    bool changes = false;       ///< It writes to drives.
    bool family_guessed = false;
    bool family_proven = false;  ///< By the identity of the drive.
    std::set<std::uint8_t> energised_before;
    std::string turn;  ///< As after --turn.
  };
  /// What a node is taken for.
  struct FoundFamily {
    std::string family;
    bool guessed = false;
    std::string turn = {};
    bool proven = false;  ///< By the identity of the drive.
    bool operator==(const FoundFamily&) const = default;
  };

  session::Options session_options();
  void show_wait(const session::Stretch* stretch, TimePoint now);
  void tell_exchange(const session::Exchange& exchange);
  void tell_order(const session::Session& session, std::uint8_t node, std::string_view order);
  void tell_family(const Run& run);
  Outcome perform_parsed(const ParsedLine& line, const Settings& settings);
  Outcome perform_parts(const ParsedLine& line, const Settings& settings, std::vector<Message>& notices);
  struct PartRun;
  Result<void> check_parts(const ParsedLine& line, const std::vector<LinePart>& parts);
  void tell_place(const Run& run);
  void judge_writes(Run& run);
  static std::string key_of(session::Session& session, std::uint8_t node);
  std::string family_by_identity(session::Session& session, std::uint8_t node);
  void keep_restarts();
  std::vector<Outcome> perform_in_turn(const ParsedLine& line, std::vector<LinePart> parts);
  std::vector<Outcome> perform_side_by_side(const ParsedLine& line, std::vector<LinePart> parts);
  std::vector<Outcome> perform_joined(const ParsedLine& line, std::vector<LinePart> parts);
  Outcome perform_part(const ParsedLine& line, LinePart part);
  Result<void> make_ready(Run& run, const command::Arguments& arguments);
  Result<void> prepare(Run& run, const command::Arguments& arguments);
  Result<void> prepare_profile(Run& run, bool changes);
  Result<void> prepare_families(Run& run);
  Result<void> ask_drive(Run& run);
  Result<const drive::Profile*> device_of_node(Run& run, const Error& why);
  Result<void> prepare_nodes(Run& run);
  void be_wary(Run& run, const command::Arguments& arguments);
  void tell_contradicted(Run& run);
  static Result<void> hold_serials(Run& run);
  void tell_trace_failure(Run& run);
  /// What a drive is decides what is said of it, whichever command made it so.
  void tell_energised(Run& run);
  /// The same of those that an earlier line told, or none. Why one does not tell what it is.
  std::optional<Errc> tell_energised_at_end();
  bool tell_lost_bus(Run& run, bool met);
  void hear_second_node(const Run& run);
  void tell_second_node(Run& run);
  /// Lines about nodes that were written to before a second one of their number was noticed; each once.
  std::vector<std::string> take_written_to_both(session::Session& session);
  /// The same for the last of several lines, before the bus is closed.
  void hear_last_line();
  void find_standard_names(Run& run);
  static Result<void> take_standard(Run& run, const Error& without);
  static Result<void> name_nodes(Run& run);
  Result<void> find_family(Run& run, bool changes);
  const FoundFamily* taken_for() const;
  Result<std::string> family_of(Run& run, session::Session& session, std::uint8_t node, bool changes);
  std::optional<show::KnownDrive> said_of(Run& run, session::Session& session,
                                          const session::Identity& identity);
  Message no_family_hint() const;
  void learn_from(Run& run);
  void remember_family(Run& run);
  bool is_contradicted(Run& run, session::Session& session, const session::Identity& identity);
  void remember(Run& run, session::Session& session, std::uint8_t node);
  void offer_turn(Run& run);
  Outcome help(const std::vector<std::string>& words, Settings settings);
  Outcome finish(Run& run, const Result<report::Value>& result);

  Console* console_;
  Options options_;
  std::recursive_mutex turn_;
  Progress progress_;
  session::Protection protection_;
  BusHolder bus_;
  bool stays_open_ = false;
  bool disables_at_end_ = false;
  bool signal_interrupts_ = false;
  /// The opening() of their bus, and the nodes that the last line told to be energised.
  std::set<std::pair<std::uint64_t, std::uint8_t>> told_energised_;
  std::vector<std::uint8_t> unheard_;  ///< Nodes of the last line, a second of which may still answer.
  std::set<std::pair<std::uint64_t, std::uint8_t>> written_;  ///< Nodes, and the opening() of their bus.
  std::optional<Error> incomplete_trace_;  ///< Told as a notice of a line; the exit code comes at the end.
  std::map<std::string, std::shared_ptr<const drive::Profile>> profiles_;
  std::map<std::string, FoundFamily> families_;  ///< Of drives, by bus, node and restarts.
  CabinetHolder cabinet_;
  std::set<std::string> shown_warnings_;  ///< Of data sheets: each is shown once in a run.
  bool cabinet_told_ = false;             ///< For --verbose, in this line.
  /// By canonical_url() and node: the families that note_family() was told.
  std::map<std::pair<std::string, std::uint8_t>, const drive::Profile*> noted_families_;
  LastWrite last_write_;
};

}  // namespace servoctl::cli
