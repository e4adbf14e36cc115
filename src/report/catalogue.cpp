#include "report/catalogue.hpp"

#include <algorithm>
#include <utility>

#include "base/number.hpp"
#include "base/text.hpp"
#include "report/text_kinds.hpp"
#include "report/text_parts.hpp"
#include "report/zh_po.hpp"

namespace servoctl::report {
namespace {

/// What has fewer says too little to be known by: `{} of {}`.
constexpr std::size_t kLeastLetters = 3;

/// Letters of a piece of a sentence that is known by itself.
constexpr std::size_t kLeastOfPiece = 8;

/// Of an entry: what stands at these arguments are names of commands, files or axes.
constexpr std::string_view kNames = "names:";

bool is_word_char(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Each once.
std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> out;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && is_word_char(text[end])) ++end;
    if (end > begin) out.push_back(text.substr(begin, end - begin));
    begin = std::max(end, begin + 1);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Without brackets around all of it.
std::string_view unbracketed(std::string_view text, std::string_view open, std::string_view close) {
  if (!text.starts_with(open) || !text.ends_with(close) || text.size() < open.size() + close.size())
    return text;
  const auto inner = text.substr(open.size(), text.size() - open.size() - close.size());
  return inner.find(open) == std::string_view::npos ? inner : text;
}

/// As bare(), of a text in Chinese.
std::string_view bare_chinese(std::string_view text) {
  for (bool again = true; again;) {
    again = false;
    for (const std::string_view mark : {" ", "\t", "\n", "，", "；", "：", "。", "、", ",", ";", ":", "."}) {
      if (text.starts_with(mark)) text.remove_prefix(mark.size()), again = true;
      if (text.ends_with(mark)) text.remove_suffix(mark.size()), again = true;
    }
  }
  return text;
}

/// A format string as what it makes of no arguments.
std::string without_places(std::string_view text) {
  return text.find_first_of("{}") == std::string_view::npos ? std::string(text) : Phrase(text).with({});
}

void keep_names(const std::vector<std::string>& remarks, Phrase& phrase) {
  for (const auto& remark : remarks)
    if (remark.starts_with(kNames))
      for (const auto name : split(std::string_view(remark).substr(kNames.size()), ','))
        if (const auto argument = parse_digits(trim(name), 10))
          phrase.keep(static_cast<std::size_t>(*argument));
}

}  // namespace

Catalogue::Catalogue(std::vector<PoEntry> entries) {
  std::unordered_map<std::string_view, std::size_t> known;
  literals_.reserve(entries.size());
  whole_.reserve(entries.size());
  patterns_.reserve(entries.size());
  for (auto& entry : entries) {
    if (entry.text.empty()) continue;
    const auto& [english, chinese] = *literals_.try_emplace(std::move(entry.id), std::move(entry.text)).first;
    const auto id = unbracketed(bare(english).text, "(", ")");
    const auto text = unbracketed(unbracketed(bare_chinese(chinese), "（", "）"), "(", ")");
    Phrase phrase(id);
    if (phrase.places().empty()) {
      whole_.emplace(phrase.pieces().front(), without_places(text));
      const bool before = english.starts_with(' ');
      const bool behind = english.ends_with(' ');
      if (phrase.letters() < kLeastOfPiece || before == behind) continue;
      // ` has no link`, `no unit answered on `: a name stands beside it.
      const auto place = [&](std::string_view words, std::string_view blank) {
        return before ? "{}" + std::string(blank) + std::string(words)
                      : std::string(words) + std::string(blank) + "{}";
      };
      phrase = Phrase(place(id, " "));
      patterns_.push_back({std::move(phrase), place(text, " ")});
      for (const auto& word : words_of(id)) ++known[word];
      continue;
    }
    keep_names(entry.remarks, phrase);
    if (phrase.letters() < kLeastLetters || phrase.words().empty()) continue;
    for (const auto& word : words_of(id)) ++known[word];
    patterns_.push_back({std::move(phrase), std::string(text)});
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    const auto words = patterns_[i].id.words();
    const auto rarest =
        std::min_element(words.begin(), words.end(), [&](auto a, auto b) { return known[a] < known[b]; });
    by_word_[std::string(*rarest)].push_back(i);
  }
}

std::string_view Catalogue::whole(std::string_view text) const {
  const auto found = whole_.find(std::string(text));
  return found == whole_.end() ? std::string_view() : std::string_view(found->second);
}

std::string_view Catalogue::literal(std::string_view text) const {
  const auto found = literals_.find(std::string(text));
  return found == literals_.end() ? std::string_view() : std::string_view(found->second);
}

std::vector<const Catalogue::Pattern*> Catalogue::candidates(std::string_view text) const {
  std::vector<const Pattern*> out;
  for (const auto& word : words_of(text))
    if (const auto found = by_word_.find(std::string(word)); found != by_word_.end())
      for (const auto i : found->second) out.push_back(&patterns_[i]);
  // Of two with as many letters that with more marks, then the earlier one.
  std::sort(out.begin(), out.end(), [](const Pattern* a, const Pattern* b) {
    if (a->id.letters() != b->id.letters()) return a->id.letters() > b->id.letters();
    return a->id.size() != b->id.size() ? a->id.size() > b->id.size() : a < b;
  });
  return out;
}

const Catalogue& chinese() {
  // Never taken down: that would take a millisecond of each call of the program.
  // A file that cannot be read is one that no test has seen: the texts stay English.
  static const auto* const catalogue =
      new Catalogue(parse_po(zh_po(), "zh.po").value_or(std::vector<PoEntry>()));
  return *catalogue;
}

std::string in_chinese(std::string_view text, const Names* names) {
  return chinese().translated(text, names);
}

void put_into_chinese(Message& message, const Names* names) {
  // Chinese has no plural.
  const auto word = [](std::string_view literal) {
    return is_plural(literal) ? std::string_view() : chinese_word(literal);
  };
  message = message.changed(word, [names](Message::Argument& argument) {
    if (auto* text = std::get_if<std::string>(&argument)) *text = in_chinese(std::string_view(*text), names);
    if (const auto* words = std::get_if<NameList>(&argument)) argument = Verbatim{words->text("、")};
  });
}

std::string_view chinese_word(std::string_view english) {
  const auto found = chinese().literal(english);
  return found.empty() ? english : found;
}

}  // namespace servoctl::report
