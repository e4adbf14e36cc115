#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/terminal/candidate_list.hpp"
#include "cli/terminal/edited_line.hpp"
#include "cli/terminal/key_decoder.hpp"
#include "cli/terminal/line_history.hpp"
#include "cli/terminal/line_screen.hpp"

namespace servoctl::cli {

/// What may stand at the end of what is typed.
struct Offer {
  std::size_t typed = 0;  ///< Bytes at the end of the text that a candidate takes the place of.
  std::vector<Candidate> candidates;
  bool inside = false;    ///< They have the text inside: none begins with it.
  std::string note = {};  ///< What may stand there where no word can be offered; shown, not put in.
};

/// A line while somebody types it: bytes of a terminal go in, text for it comes out, and nothing is waited
/// for. Keys are those of Emacs, as in shells; Ctrl-R searches the history, Tab completes. Of a paste of
/// several lines none is run by itself: each waits for Enter. Marks of the terminal tell a paste, or who
/// reads the keys does.
class LineEditor {
 public:
  enum class Step : std::uint8_t { goes_on, line, end };
  struct Host {
    std::function<Screen::Size()> size;
    std::function<Offer(std::string_view before)> offer;
    std::function<std::string(std::string_view text)> in_language = {};  ///< Of who types; may be empty.
    std::function<bool()> is_ascii = {};  ///< Whether what is shown has to be ASCII; may be empty.
  };

  /// The history outlives it; it is not added to.
  LineEditor(const LineHistory& history, Host host) : history_(&history), host_(std::move(host)) {}

  /// Begins the next line: an empty one, or the next of those that were pasted.
  void begin();
  void set_prompt(PromptText prompt) { prompt_ = std::move(prompt); }
  const PromptText& prompt() const { return prompt_; }

  /// Takes in one byte. `line`: Enter was pressed, text() is it. `end`: Ctrl-D on an empty line.
  Step take(char byte);
  /// Takes in one byte behind an Enter that take() told, and that is not obeyed: what comes faster than
  /// anyone types is a paste, though nothing marks it.
  void take_behind(char byte);
  /// All of that has come: its lines wait for Enter, and so does the one before it.
  void hold_behind();
  /// Whether a paste or a key has begun and not ended: the next byte is of it.
  bool is_inside_key() const { return keys_.is_inside(); }
  /// Waits no longer for the end of a paste or of a key.
  void forget_key() { keys_ = {}; }
  /// Whether lines of a paste wait for Enter.
  bool waits_pasted() const { return !pasted_.empty(); }
  std::string text() const { return line_.text(); }
  /// Drops the line, and what else was pasted.
  void drop();

  /// Nothing of it is on the screen any more.
  void forget_screen() { screen_.forget(); }
  /// What stands below a line while others wait; empty when none do.
  std::string waiting_note() const;
  /// What to write so that the terminal shows all as it is now.
  std::string draw();
  /// What to write before other text: the line is gone until draw().
  std::string wipe() { return screen_.wipe(host_.size()); }
  /// What to write when a line is done: it stays, with this behind it.
  std::string leave(std::string_view behind = {});

 private:
  struct Search {
    std::string text;
    std::optional<std::size_t> at;
    bool found = true;
    std::string before;  ///< The line when it began.
  };

  Step press(const KeyPress& key);
  void edit(const KeyPress& key);
  bool move_in_history(KeyPress::Kind kind);
  void go_to(std::size_t place);
  void paste(std::string_view text);
  void wait(std::string_view lines);
  std::string say(std::string_view text) const;
  void search(const KeyPress& key, bool older);
  void look(bool older, bool anew);
  bool goes_on_searching(const KeyPress& key);
  void complete();
  std::size_t rows_for_list() const;
  LineScreen::Picture picture() const;

  const LineHistory* history_;
  Host host_;
  KeyDecoder keys_;
  EditedLine line_;
  LineScreen screen_;
  PromptText prompt_;
  std::size_t place_ = 0;  ///< Of the line in the history; its size: one that is being typed.
  std::string draft_;      ///< That one, while another is shown.
  std::optional<Search> search_;
  std::deque<std::string> pasted_;  ///< Lines that wait.
  std::string behind_;              ///< Those that still come.
  std::vector<Candidate> listed_;   ///< Until the next key.
  std::string note_;                ///< In their place.
  bool clears_ = false;             ///< The screen, before the next picture.
};

}  // namespace servoctl::cli
