#include "show/topic_page.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/folded.hpp"
#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "report/chinese_marks.hpp"
#include "report/chinese_value.hpp"

namespace servoctl::show {
namespace {

using Lines = std::vector<std::string>;

constexpr std::size_t kGap = 2;

/// Whatever marks the file has, those of Chinese.
std::string in_language(const std::string& english, const std::string& zh, bool chinese) {
  return chinese && !zh.empty() ? report::chinese_marks(zh) : english;
}

/// Names in Chinese are for who reads it; a terminal without UTF-8 could only show their numbers.
bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// A word of the program.
std::string_view word(std::string_view english, bool chinese) {
  return chinese ? report::chinese_word(english) : english;
}

/// The text behind `head`, its further lines below its beginning.
void add_hanging(std::string_view head, std::string_view text, std::size_t width, Lines& out) {
  const auto indent = display_width(head);
  auto left = std::string(head);
  for (const auto& line : broken_lines(text, width > indent ? width - indent : 1)) {
    out.push_back(left + line);
    out.back().erase(out.back().find_last_not_of(' ') + 1);
    left.assign(indent, ' ');
  }
}

/// Paragraphs; the line breaks inside one are those of the file.
void add_paragraphs(std::string_view text, std::size_t width, Lines& out) {
  std::string paragraph;
  const auto end = [&] {
    if (!trim(paragraph).empty()) {
      out.emplace_back();
      add_hanging("", paragraph, width, out);
    }
    paragraph.clear();
  };
  for (const auto line : split(text, '\n')) {
    if (trim(line).empty())
      end();
    else
      append(paragraph, line, " ");
  }
  end();
}

/// A cell, or a line of a picture, in Chinese. Its words stand where they stood.
std::string in_words(std::string text, const drive::Topic& topic) {
  const auto is_letter = [&](std::size_t at) {
    return at < text.size() && ((text[at] >= 'a' && text[at] <= 'z') || (text[at] >= 'A' && text[at] <= 'Z'));
  };
  for (const auto& [english, chinese] : topic.words_zh)
    for (auto at = text.find(english); at != std::string::npos; at = text.find(english, at + 1)) {
      auto size = english.size();
      if ((at > 0 && is_letter(at - 1)) || is_letter(at + size)) continue;
      auto room = display_width(english);
      // What is wider takes the blanks behind it, but for one.
      while (room < display_width(chinese) && text.compare(at + size, 2, "  ") == 0) ++size, ++room;
      const bool before_blank = at + size < text.size() && text[at + size] == ' ';
      text.replace(at, size, before_blank ? pad_right(chinese, room) : chinese);
    }
  return text;
}

/// The rows of a topic as columns: the cells, and behind them what the row is about.
class TopicTable {
 public:
  TopicTable(const Explanation& explanation, bool chinese, std::size_t width)
      : topic_(explanation.topic), rows_(explanation.rows), chinese_(chinese), width_(width) {
    if (rows_.empty())
      for (std::size_t i = 0; i < topic_.rows.size(); ++i) rows_.push_back(i);
    heads_ = chinese && !topic_.columns_zh.empty() ? topic_.columns_zh : topic_.columns;
    for (std::size_t column = 0; column < heads_.size(); ++column) {
      widths_.push_back(display_width(heads_[column]));
      for (const auto row : rows_)
        widths_[column] = std::max(widths_[column], display_width(cell(topic_.rows[row].cells[column])));
    }
  }

  void add_to(Lines& out) const {
    out.emplace_back();
    out.push_back(cells_of(heads_));
    out.back().erase(out.back().find_last_not_of(' ') + 1);
    for (const auto row : rows_) add_row(topic_.rows[row], out);
  }

 private:
  static constexpr std::size_t kLeastText = 24;
  static constexpr std::size_t kBelow = 4;

  std::string cells_of(const std::vector<std::string>& cells) const {
    std::string out;
    for (std::size_t i = 0; i < cells.size(); ++i) out += pad_right(cell(cells[i]), widths_[i] + kGap);
    return out;
  }

  /// A cell is one word or none: `off` is not the end of `cut-off`.
  std::string cell(const std::string& english) const {
    if (chinese_)
      for (const auto& [word, chinese] : topic_.words_zh)
        if (word == english) return chinese;
    return english;
  }

  /// Where the cells leave too little room, the text stands below them.
  void add_row(const drive::TopicRow& row, Lines& out) const {
    const auto left = cells_of(row.cells);
    const auto text = in_language(row.text, row.text_zh, chinese_);
    const auto used = display_width(left);
    if (used <= width_ + kGap && (text.empty() || used + kLeastText <= width_))
      return add_hanging(left, text, width_, out);
    const auto cells = used <= width_ + kGap ? Lines{left} : broken_lines(left, width_ - kBelow);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      out.push_back((i == 0 ? "" : std::string(kBelow, ' ')) + cells[i]);
      out.back().erase(out.back().find_last_not_of(' ') + 1);
    }
    if (!text.empty()) add_hanging(std::string(kBelow, ' '), text, width_, out);
  }

  const drive::Topic& topic_;
  std::vector<std::size_t> rows_;
  bool chinese_;
  std::size_t width_;
  std::vector<std::string> heads_;
  std::vector<std::size_t> widths_;
};

void add_picture(const drive::Topic& topic, bool chinese, Lines& out) {
  out.emplace_back();
  for (const auto line : split(std::string_view(topic.picture), '\n'))
    out.push_back(chinese ? in_words(std::string(line), topic) : std::string(line));
  while (!out.empty() && trim(out.back()).empty()) out.pop_back();
}

/// `6692-6711 6801` → `6692–6711, 6801`.
std::string lines_in_words(std::string_view line) {
  std::string out;
  for (const auto part : split(line, ' ')) {
    auto range = std::string(part);
    if (const auto dash = range.find('-'); dash != std::string::npos) range.replace(dash, 1, "–");
    append(out, range);
  }
  return out;
}

std::string object_in_words(const drive::Topic& topic) {
  if (!topic.object) return {};
  const auto object = to_string(*topic.object);
  return topic.value ? formatted("{} = {}", object, *topic.value) : object;
}

/// Where it comes from, and what is to be minded.
void add_marks(const Explanation& explanation, bool chinese, std::size_t width, Lines& out) {
  const auto& topic = explanation.topic;
  const bool of_manual = !topic.line.empty() && topic.line.front() >= '0' && topic.line.front() <= '9';
  const auto only = explanation.rows.size() == 1 ? topic.rows[explanation.rows.front()].line : std::string();
  const auto line = of_manual ? lines_in_words(only.empty() ? topic.line : only) : topic.line;
  std::string also;
  if (explanation.rows.empty())
    for (const auto& name : topic.also)
      if (chinese || is_ascii(name)) append(also, name);
  // A record tells the rest itself.
  const bool bare = explanation.details.is_null();
  const std::pair<std::string_view, std::string> marks[] = {
      {"kind", bare ? std::string(word(topic.kind, chinese)) : std::string()},
      {"name", bare ? topic.name : std::string()},
      {"also", chinese ? report::chinese_marks(also) : also},
      {"family", topic.family},
      {"object", bare ? object_in_words(topic) : std::string()},
      {"note", in_language(topic.note, topic.note_zh, chinese)},
      {"assumed", std::string(topic.assumed ? word("the manual does not state all of it", chinese) : "")},
      {"picture",
       std::string(topic.figure ? word("the manual has part of it as a picture only: see there", chinese)
                                : "")},
      {of_manual ? "manual line" : "source", bare ? line : std::string()}};
  std::size_t left = 0;
  for (const auto& mark : marks)
    if (!mark.second.empty()) left = std::max(left, display_width(word(mark.first, chinese)));
  out.emplace_back();
  for (const auto& mark : marks)
    if (!mark.second.empty())
      add_hanging(pad_right(std::string(word(mark.first, chinese)), left + kGap), mark.second, width, out);
}

}  // namespace

Lines topic_page(const Explanation& explanation, bool chinese, std::size_t width) {
  const auto& topic = explanation.topic;
  Lines out;
  add_hanging("", in_language(topic.title, topic.title_zh, chinese), width, out);
  if (explanation.rows.empty()) add_paragraphs(in_language(topic.text, topic.text_zh, chinese), width, out);
  if (!topic.rows.empty()) TopicTable(explanation, chinese, width).add_to(out);
  if (explanation.rows.empty() && !topic.picture.empty()) add_picture(topic, chinese, out);
  if (!explanation.details.is_null()) {
    out.emplace_back();
    const auto details =
        report::to_text(chinese ? report::chinese_value(explanation.details) : explanation.details, width);
    for (const auto line : split(std::string_view(details), '\n')) out.emplace_back(line);
    while (out.back().empty()) out.pop_back();
  }
  add_marks(explanation, chinese, width, out);
  for (auto& line : out) line = printable(line);
  return out;
}

namespace {

std::vector<std::string_view> kinds_of(std::span<const Explanation> explanations) {
  std::vector<std::string_view> out;
  for (const auto& each : explanations)
    if (std::find(out.begin(), out.end(), each.topic.kind) == out.end()) out.push_back(each.topic.kind);
  return out;
}

}  // namespace

Lines topic_names(std::span<const Explanation> explanations, bool chinese, std::size_t width) {
  const auto kinds = kinds_of(explanations);
  std::size_t left = 0;
  for (const auto kind : kinds) left = std::max(left, display_width(word(kind, chinese)));
  Lines out;
  for (const auto kind : kinds) {
    std::vector<std::string_view> names;
    for (const auto& each : explanations)
      if (each.topic.kind == kind && std::find(names.begin(), names.end(), each.topic.name) == names.end())
        names.push_back(each.topic.name);
    add_hanging(pad_right(std::string(word(kind, chinese)), left + kGap),
                formatted("{}", fmt::join(names, ", ")), width, out);
  }
  for (auto& line : out) line = printable(line);
  return out;
}

Lines topic_list(std::span<const Explanation> explanations, bool chinese, std::size_t width,
                 bool with_families) {
  constexpr std::size_t kWidestName = 24;
  const auto kinds = kinds_of(explanations);
  std::size_t left = 0;
  std::size_t family = 0;
  for (const auto& each : explanations) {
    left = std::max(left, std::min(display_width(each.topic.name), kWidestName));
    if (with_families) family = std::max(family, display_width(each.topic.family) + kGap);
  }
  Lines out;
  for (const auto kind : kinds) {
    if (!out.empty()) out.emplace_back();
    out.emplace_back(word(kind, chinese));
    for (const auto& each : explanations) {
      if (each.topic.kind != kind) continue;
      auto head = "  " + pad_right(clip(each.topic.name, kWidestName), left + kGap);
      if (with_families) head += pad_right(each.topic.family, family);
      add_hanging(head, in_language(each.topic.title, each.topic.title_zh, chinese), width, out);
    }
  }
  for (auto& line : out) line = printable(line);
  return out;
}

}  // namespace servoctl::show
