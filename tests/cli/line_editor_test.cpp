// A line while it is typed: what the terminal shows is worked out by a small terminal of the test's own.
#include "cli/terminal/line_editor.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl::cli {
namespace {

/// As much of an xterm as the editor needs; a wide character takes two cells, and one that does not fit goes
/// to the next row.
class SmallTerminal {
 public:
  SmallTerminal(std::size_t columns, std::size_t rows) : columns_(columns), rows_(rows, Row(columns)) {}

  void write(std::string_view text) {
    while (!text.empty()) {
      const auto point = decode_utf8(text);
      const auto bytes = text.substr(0, point.size);
      text.remove_prefix(point.size);
      if (bytes == "\x1B")
        text.remove_prefix(obey(text));
      else if (bytes == "\r")
        column_ = 0;
      else if (bytes == "\n")
        down();
      else
        put(bytes, columns(*point.value));
    }
  }
  std::string row(std::size_t i) const {
    std::string out;
    for (const auto& cell : rows_[i]) out += cell;
    while (out.ends_with(' ')) out.pop_back();
    return out;
  }
  std::size_t cursor_row() const { return row_; }
  std::size_t cursor_column() const { return column_; }

 private:
  using Row = std::vector<std::string>;
  void down() {
    if (++row_ < rows_.size()) return;
    row_ = rows_.size() - 1;
    rows_.erase(rows_.begin());
    rows_.emplace_back(columns_);
  }
  void put(std::string_view text, std::size_t width) {
    if (width == 0) {
      rows_[row_][column_ - 1] += text;
      return;
    }
    if (column_ + width > columns_) {
      column_ = 0;
      down();
    }
    rows_[row_][column_] = text;
    for (std::size_t i = 1; i < width; ++i) rows_[row_][column_ + i].clear();
    column_ += width;
  }
  /// Bytes of the sequence.
  std::size_t obey(std::string_view text) {
    const auto end = text.find_first_of("ABCDHJKmhl");
    const auto number = text.substr(1, end - 1);
    const auto count = number.empty() || number[0] == '?' ? 0 : std::stoul(std::string(number));
    if (text[end] == 'A') row_ -= count;
    if (text[end] == 'C') column_ += count;
    if (text[end] == 'J') {
      for (auto c = column_; c < columns_; ++c) rows_[row_][c] = " ";
      for (auto r = row_ + 1; r < rows_.size(); ++r) rows_[r] = Row(columns_, " ");
    }
    return end + 1;
  }
  std::size_t columns_;
  std::vector<Row> rows_;
  std::size_t row_ = 0;
  std::size_t column_ = 0;
};

class LineEditing : public testing::Test {
 protected:
  void SetUp() override {
    editor.set_prompt({.text = "servoctl> ", .alarm = false});
    editor.begin();
  }
  LineEditor::Step type(std::string_view text) {
    auto step = LineEditor::Step::goes_on;
    for (const char c : text) {
      step = editor.take(c);
      screen.write(editor.draw());
    }
    return step;
  }
  void enter() {
    type("\r");
    history.add(editor.text());
    screen.write(editor.leave());
    editor.begin();
  }
  LineHistory history;
  std::vector<Candidate> candidates;
  std::string note;
  SmallTerminal screen{20, 8};
  LineEditor editor{history, LineEditor::Host{.size =
                                                  [] {
                                                    return Screen::Size{20, 8};
                                                  },
                                              .offer =
                                                  [this](std::string_view before) {
                                                    const auto blank = before.rfind(' ');
                                                    Offer out{.typed = before.size() - (blank + 1),
                                                              .candidates = candidates,
                                                              .note = note};
                                                    return out;
                                                  }}};
};

TEST_F(LineEditing, AWideCharacterThatDoesNotFitStandsOnTheNextRowAndTheCursorWithIt) {
  type("a速度环增益坏");
  EXPECT_EQ(screen.row(0), "servoctl> a速度环增");
  EXPECT_EQ(screen.row(1), "益坏");
  EXPECT_EQ(screen.cursor_row(), 1U);
  EXPECT_EQ(screen.cursor_column(), 4U);
  type("\x1B[D\x1B[D");
  EXPECT_EQ(screen.cursor_row(), 1U);
  EXPECT_EQ(screen.cursor_column(), 0U);
  type("\x1B[D\x7F");
  EXPECT_EQ(editor.text(), "a速度增益坏");
}

TEST_F(LineEditing, AfterAnInsertionInTheMiddleTheCursorStandsBehindIt) {
  type("速度环增益坏");
  type("\x01\x1B[C\x1B[CY");
  EXPECT_EQ(screen.row(0), "servoctl> 速度Y环增");
  EXPECT_EQ(screen.row(1), "益坏");
  EXPECT_EQ(screen.cursor_row(), 0U);
  EXPECT_EQ(screen.cursor_column(), 15U);
  type("\x7F");
  EXPECT_EQ(screen.row(0), "servoctl> 速度环增益");
  EXPECT_EQ(screen.row(1), "坏");
  EXPECT_EQ(screen.cursor_column(), 14U);
}

TEST_F(LineEditing, BytesOfACharacterMayComeInPieces) {
  screen.write(editor.draw());
  editor.take('\xE9');
  editor.take('\x80');
  EXPECT_EQ(editor.text(), "");
  editor.take('\x9F');
  EXPECT_EQ(editor.text(), "速");
  type("\xFF\x80x");  // Bytes of no character.
  EXPECT_EQ(editor.text(), "速x");
}

TEST_F(LineEditing, HistoryIsSearchedForChinese) {
  for (const auto* line : {"param search 速度环", "param search 位置环", "read statusword"}) {
    type(line);
    enter();
  }
  type("draft\x12环");
  EXPECT_EQ(editor.text(), "param search 位置环");
  type("\x12");
  EXPECT_EQ(editor.text(), "param search 速度环");
  type("\x12");  // There is no older one.
  EXPECT_EQ(editor.text(), "param search 速度环");
  EXPECT_TRUE(screen.row(screen.cursor_row() - 1).starts_with("(not found: '环')")) << screen.row(0);
  type("\x13");
  EXPECT_EQ(editor.text(), "param search 位置环");
  type("\x07");
  EXPECT_EQ(editor.text(), "draft");
  type("\x15\x12速度\x7F度\r");
  EXPECT_EQ(editor.text(), "param search 速度环");
}

TEST_F(LineEditing, ArrowsGoThroughTheHistoryAndBackToWhatWasBegun) {
  type("first");
  enter();
  type("second");
  enter();
  type("begun\x1B[A\x1B[A\x1B[A");
  EXPECT_EQ(editor.text(), "first");
  type("\x1B[B\x1B[B");
  EXPECT_EQ(editor.text(), "begun");
}

TEST_F(LineEditing, NoLineOfAPasteRunsByItself) {
  EXPECT_EQ(type("\x1B[200~nmt reset\ny\n\n速度\n\x1B[201~"), LineEditor::Step::goes_on);
  EXPECT_EQ(editor.text(), "nmt reset");
  EXPECT_TRUE(screen.row(1).starts_with("(2 more lines")) << screen.row(1);
  EXPECT_EQ(type("\r"), LineEditor::Step::line);
  editor.begin();
  EXPECT_EQ(editor.text(), "y");
  editor.drop();
  EXPECT_EQ(editor.text(), "");
  editor.begin();
  EXPECT_EQ(editor.text(), "");
}

TEST_F(LineEditing, APasteBringsNoControlCharacters) {
  type("\x1B[200~a\x1B[31mb\xE2\x80\xAE\tc\x1B[201~");
  EXPECT_EQ(editor.text(), "a[31mb c");
}

TEST_F(LineEditing, TabLeavesLettersAsTheyWereTypedWhereCandidatesDifferInTheirCase) {
  candidates = {{"LiftA", ""}, {"liftB", ""}};
  type("use li\t");
  EXPECT_EQ(editor.text(), "use lift");
  candidates = {{"Pn0214", ""}, {"Pn0217", ""}};
  type("\x15get pn\t");
  EXPECT_EQ(editor.text(), "get Pn021");
}

TEST_F(LineEditing, TabGoesAsFarAsAllAgreeAndShowsThem) {
  candidates = {{"速度环增益1", "Pn0214"}, {"速度环增益2", "Pn0217"}};
  type("get 速\t");
  EXPECT_EQ(editor.text(), "get 速度环增益");
  EXPECT_TRUE(screen.row(2).starts_with("速度环增")) << screen.row(2);
  EXPECT_EQ(screen.cursor_row(), 1U);
  type("2");
  EXPECT_EQ(screen.row(2), "");
  candidates = {{"速度环增益2", ""}};
  type("\t");
  EXPECT_EQ(editor.text(), "get 速度环增益2 ");
}

TEST_F(LineEditing, MoreCandidatesThanFitAreCountedAndNothingIsAsked) {
  for (int i = 0; i < 300; ++i) candidates.push_back({"Pn" + std::to_string(1000 + i), "x"});
  type("p\t");
  EXPECT_EQ(editor.text(), "Pn1");
  EXPECT_NE(screen.row(6).find("more"), std::string::npos) << screen.row(6);
  EXPECT_TRUE(screen.row(0).starts_with("servoctl> Pn1"));
  type("0");
  EXPECT_EQ(screen.row(1), "");
}

TEST_F(LineEditing, ANoteIsShownAndNotPutIn) {
  note = "1..5000 Hz";
  type("set \t");
  EXPECT_EQ(editor.text(), "set ");
  EXPECT_EQ(screen.row(1), "1..5000 Hz");
}

TEST_F(LineEditing, ALineThatIsHigherThanTheTerminalShowsThePartAroundTheCursor) {
  type(std::string(400, 'x'));
  EXPECT_EQ(screen.cursor_row(), 7U);
  EXPECT_EQ(editor.text().size(), 400U);
  type("\x01");
  EXPECT_TRUE(screen.row(0).starts_with("servoctl> xxx"));
  EXPECT_EQ(screen.cursor_column(), 10U);
}

TEST_F(LineEditing, WordsAreCutAndPutBack) {
  type("param set Pn0214 速度\x17");
  EXPECT_EQ(editor.text(), "param set Pn0214 ");
  type("\x19");
  EXPECT_EQ(editor.text(), "param set Pn0214 速度");
  type(
      "\x1B\x7F\x1B"
      "b"
      "\x1B"
      "d");
  EXPECT_EQ(editor.text(), "param set  ");
  type("\x01\x0B");
  EXPECT_EQ(editor.text(), "");
  EXPECT_EQ(type("\x04"), LineEditor::Step::end);
}

TEST(LineHistories, ReadWhatLibeditWroteAndKeepWhatAnotherPromptAdded) {
  const auto file = std::filesystem::temp_directory_path() / ("history-" + std::to_string(::getpid()));
  std::ofstream(file) << "_HiStOrY_V2_\nparam\\040search\\040速度\nread\\0400x6041\n";
  LineHistory one;
  one.load(file);
  ASSERT_EQ(one.size(), 2U);
  EXPECT_EQ(one.at(0), "param search 速度");
  LineHistory other;
  other.load(file);
  one.add("of one");
  other.add("of another");
  EXPECT_TRUE(one.save(file));
  EXPECT_TRUE(other.save(file));
  LineHistory both;
  both.load(file);
  ASSERT_EQ(both.size(), 4U);
  EXPECT_EQ(both.at(2), "of one");
  EXPECT_EQ(both.at(3), "of another");
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace servoctl::cli
