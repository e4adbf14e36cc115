#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drive/everyday_words.hpp"
#include "drive/topics.hpp"
#include "show/said_words.hpp"
#include "show/words_in_text.hpp"

namespace servoctl::show {

/// How something was found, the best first.
enum class Found : std::uint8_t { object, parameter, fault, abort, exit, name, value, row, title, text };

std::string_view name(Found found);  ///< As the enumerators are called.

/// Why a topic is an answer.
struct TopicMatch {
  Found found = Found::text;
  std::vector<std::size_t> rows = {};  ///< Of Found::row: which.
};

/// What somebody wants explained: a name, words in any language, a number behind the name of what it counts
/// (`homing 7`, `DI 28`), or an object and its value (`6098h=7`). Case, full-width forms and the number of
/// blanks make no difference.
class TopicQuery {
 public:
  /// `everyday` is what people call things; it outlives the query.
  explicit TopicQuery(std::string_view words, std::span<const drive::EverydayWords> everyday = {});

  /// Other words, understood in the same way.
  TopicQuery of(std::string_view words) const { return TopicQuery(words, everyday_); }

  const std::string& whole() const { return whole_; }  ///< As it was typed, but for blanks.
  /// Of an object and its value, the object as it was typed; else all that was typed.
  const std::string& subject() const { return subject_; }
  bool has_value() const { return assigned_; }  ///< `6098h=7`.
  /// Whether the name is what was typed; blanks and `_` in them make no difference.
  bool names(std::string_view name) const;
  /// The same of what a panel shows, where people leave out marks and zeros: `AL9` and `al 09` are `AL.09`.
  bool names_display(std::string_view shown) const;
  /// Whether all words stand in the texts, in any order, as they were typed or as people say it otherwise.
  /// They are searchable().
  bool mentions(std::string_view texts) const { return words_.are_in(texts); }
  const drive::EverydayWords* thing() const { return words_.thing(); }  ///< See SaidWords.

  /// Why the topic is an answer, by the best reason; empty where it is none. `dictionary` knows the names of
  /// objects; null: only their indexes are understood.
  std::optional<TopicMatch> match(const drive::Topic& topic, const od::Dictionary* dictionary) const;
  /// The same where only a name, or a cell that is all that was typed, is an answer.
  std::optional<TopicMatch> match_name(const drive::Topic& topic) const;

 private:
  bool names_topic(const drive::Topic& topic) const;
  bool names_value(const drive::Topic& topic, const od::Dictionary* dictionary) const;
  bool is_counted(const drive::Topic& topic, std::size_t column, std::string_view cell,
                  std::size_t numbers) const;
  std::vector<std::size_t> rows_of(const drive::Topic& topic, bool counted) const;

  std::span<const drive::EverydayWords> everyday_;
  std::string whole_;
  std::string subject_;
  std::string key_;
  SaidWords words_;
  std::string counted_;                 ///< What is before the last word, or the `=`.
  std::optional<std::int64_t> number_;  ///< The last word, or what is behind the `=`.
  bool assigned_ = false;
};

}  // namespace servoctl::show
