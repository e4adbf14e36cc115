#include "cli/terminal/line_editor.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "cli/terminal/ascii_form.hpp"

namespace servoctl::cli {
namespace {

using PressKind = KeyPress::Kind;

constexpr std::string_view kClearScreen = "\x1B[H\x1B[2J";
constexpr std::size_t kFewRows = 3;

bool is_search(PressKind kind) { return kind == PressKind::search_older || kind == PressKind::search_newer; }

/// Without its last character.
void drop_last(std::string& text) {
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text.back());
    text.pop_back();
    if ((byte & 0xC0U) != 0x80) return;
  }
}

/// What is typed too: who has no such characters would see others in their place.
void put_into_ascii(LineScreen::Picture& picture, std::size_t columns) {
  picture.prompt.text = ascii_form(picture.prompt.text);
  for (auto& character : picture.characters) character = ascii_form(character);
  for (auto& row : picture.below) row = ascii_clip(ascii_form(row), columns - 1);
}

}  // namespace

void LineEditor::begin() {
  line_.set({});
  place_ = history_->size();
  draft_.clear();
  search_.reset();
  listed_.clear();
  note_.clear();
  if (pasted_.empty()) return;
  line_.set(pasted_.front());
  pasted_.pop_front();
}

void LineEditor::drop() {
  pasted_.clear();
  begin();
}

std::string LineEditor::draw() {
  std::string out;
  if (std::exchange(clears_, false)) {
    screen_.forget();
    out = kClearScreen;
  }
  return out + screen_.show(picture(), host_.size());
}

std::string LineEditor::leave(std::string_view behind) {
  auto last = picture();
  for (const char c : behind) last.characters.emplace_back(1, c);
  return screen_.leave(last, host_.size());
}

LineEditor::Step LineEditor::take(char byte) {
  const auto key = keys_.take(byte);
  return key ? press(*key) : Step::goes_on;
}

LineEditor::Step LineEditor::press(const KeyPress& key) {
  listed_.clear();
  note_.clear();
  if (search_ && goes_on_searching(key)) return Step::goes_on;
  if (key.kind == PressKind::enter) return Step::line;
  if (key.kind == PressKind::end_of_input && line_.empty()) return Step::end;
  if (key.kind == PressKind::tab)
    complete();
  else if (key.pasted)
    paste(key.text);
  else if (is_search(key.kind))
    search_ = Search{.text = {}, .at = std::nullopt, .before = line_.text()};
  else if (!move_in_history(key.kind))
    edit(key);
  return Step::goes_on;
}

void LineEditor::edit(const KeyPress& key) {
  switch (key.kind) {
    case PressKind::text: return line_.insert(key.text);
    case PressKind::end_of_input:
    case PressKind::erase_at: return line_.erase_at();
    case PressKind::erase_before: return line_.erase_before();
    case PressKind::left: return line_.left();
    case PressKind::right: return line_.right();
    case PressKind::word_left: return line_.word_left();
    case PressKind::word_right: return line_.word_right();
    case PressKind::home: return line_.home();
    case PressKind::end: return line_.end();
    case PressKind::cut_to_end: return line_.cut_to_end();
    case PressKind::cut_to_start: return line_.cut_to_start();
    case PressKind::cut_word: return line_.cut_word();
    case PressKind::cut_word_left: return line_.cut_word_left();
    case PressKind::cut_word_right: return line_.cut_word_right();
    case PressKind::put_back: return line_.put_back();
    case PressKind::swap: return line_.swap();
    case PressKind::clear_screen: clears_ = true; return;
    default: return;
  }
}

bool LineEditor::move_in_history(PressKind kind) {
  const auto last = history_->size();
  if (kind == PressKind::older && place_ > 0)
    go_to(place_ - 1);
  else if (kind == PressKind::newer && place_ < last)
    go_to(place_ + 1);
  else if (kind == PressKind::oldest && last > 0)
    go_to(0);
  else if (kind == PressKind::newest)
    go_to(last);
  else
    return kind == PressKind::older || kind == PressKind::newer;
  return true;
}

void LineEditor::take_behind(char byte) {
  const auto key = keys_.take(byte);
  if (!key) return;
  if (key->pasted || key->kind == PressKind::text) behind_ += key->text;
  if (key->kind == PressKind::enter) behind_ += '\n';
}

void LineEditor::hold_behind() { wait(std::exchange(behind_, {})); }

/// What is changed in a line of the history is not kept.
void LineEditor::go_to(std::size_t place) {
  if (place_ == history_->size()) draft_ = line_.text();
  place_ = place;
  line_.set(place_ == history_->size() ? draft_ : history_->at(place_));
}

void LineEditor::paste(std::string_view text) {
  const auto end = std::min(text.find_first_of("\r\n"), text.size());
  line_.insert(text.substr(0, end));
  wait(text.substr(end));
}

void LineEditor::wait(std::string_view lines) {
  while (!lines.empty()) {
    const auto end = std::min(lines.find_first_of("\r\n"), lines.size());
    if (const auto next = trim(lines.substr(0, end)); !next.empty()) pasted_.emplace_back(next);
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
}

std::string LineEditor::say(std::string_view text) const {
  return host_.in_language ? host_.in_language(text) : std::string(text);
}

std::string LineEditor::waiting_note() const {
  if (pasted_.empty()) return {};
  return say(pasted_.size() == 1
                 ? "(1 more line waits: Enter runs this one, Ctrl-C drops all)"
                 : formatted("({} more lines wait: Enter runs this one, Ctrl-C drops all)", pasted_.size()));
}

/// False when the key ends the search and still has to be obeyed.
bool LineEditor::goes_on_searching(const KeyPress& key) {
  if (key.kind == PressKind::text) {
    search_->text += key.text.substr(0, key.text.find_first_of("\r\n"));
    look(true, true);
  } else if (key.kind == PressKind::erase_before) {
    drop_last(search_->text);
    search_->at.reset();
    look(true, true);
  } else if (is_search(key.kind)) {
    look(key.kind == PressKind::search_older, false);
  } else if (key.kind == PressKind::cancel) {
    line_.set(search_->before);
    search_.reset();
  } else {
    if (search_->at) place_ = *search_->at;
    search_.reset();
    return false;
  }
  return true;
}

/// `anew`: the line that is shown may be the one.
void LineEditor::look(bool older, bool anew) {
  auto& search = *search_;
  if (search.text.empty()) return;
  const auto from = search.at.value_or(history_->size());
  const auto found = older ? history_->find_older(search.text, from + (anew && search.at ? 1 : 0))
                           : history_->find_newer(search.text, from);
  search.found = found.has_value();
  if (!found) return;
  search.at = found;
  line_.set(history_->at(*found));
}

void LineEditor::complete() {
  const auto before = line_.before_cursor();
  auto offer = host_.offer(before);
  if (offer.candidates.empty()) {
    if (!offer.note.empty()) note_ = printable(offer.note);
    return;
  }
  const auto typed = std::string_view(before).substr(before.size() - std::min(offer.typed, before.size()));
  if (offer.candidates.size() == 1) {
    // What goes on behind it: a URL, a folder, a list.
    const auto& only = offer.candidates.front().word;
    const bool opens = only.find_last_of(":/=") == only.size() - 1;
    line_.replace_before(typed.size(), only + (opens ? "" : " "));
    return;
  }
  if (const auto further = begun_further(offer.candidates, typed); !offer.inside && !further.empty())
    line_.replace_before(typed.size(), further);
  listed_ = std::move(offer.candidates);
}

std::size_t LineEditor::rows_for_list() const {
  const auto size = usable_size(host_.size());
  const auto width = display_width(prompt_.text) + display_width(line_.text()) + 2;
  const auto own = 1 + width / size.columns;
  return size.rows > own + kFewRows ? size.rows - own - 1 : kFewRows;
}

LineScreen::Picture LineEditor::picture() const {
  const auto columns = usable_size(host_.size()).columns;
  LineScreen::Picture out{
      .prompt = prompt_, .characters = line_.characters(), .cursor = line_.cursor(), .below = {}};
  if (!listed_.empty()) out.below = candidate_rows(listed_, columns, rows_for_list());
  if (!out.below.empty() && out.below.back().starts_with("... ")) out.below.back() = say(out.below.back());
  if (!note_.empty()) out.below.push_back(clip(note_, columns - 1));
  if (search_)
    out.prompt.text = say(search_->found ? formatted("(search '{}')", search_->text)
                                         : formatted("(not found: '{}')", search_->text)) +
                      " ";
  if (!pasted_.empty()) out.below.push_back(clip(waiting_note(), columns - 1));
  if (host_.is_ascii && host_.is_ascii()) put_into_ascii(out, columns);
  return out;
}

}  // namespace servoctl::cli
