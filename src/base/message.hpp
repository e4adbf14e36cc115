#pragma once

#include <fmt/core.h>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/boxed.hpp"

namespace servoctl {

class Message;

/// Nodes in a message, each from 1 to 127: `node {}` is `node 3`, or `feeder` for who knows it by that name.
struct Nodes {
  std::vector<std::uint8_t> numbers;
  std::vector<std::string> names = {};  ///< Of each of them, empty where it has none; or none at all.

  /// `3`, `feeder`, `feeder, 4`.
  std::string text() const;
};

/// What is the same for everybody: the name of a file, what a drive or a person wrote.
struct Verbatim {
  std::string text;
};

/// Names in a row, which stay as they are: `a, b`, in Chinese `a、b`.
struct NameList {
  std::vector<std::string> words;

  std::string text(std::string_view between) const;
};

/// What is said to a person before it is a sentence: a text of the program, the key of the catalogue, and
/// the values of its placeholders. It becomes a sentence where it is shown, in the language of who reads,
/// with the names of axes and with the place of the commands in backticks.
class Message {
 public:
  /// A text that was put together elsewhere is looked at as a whole.
  using Argument = std::variant<std::string, Verbatim, NameList, std::int64_t, std::uint64_t, double, Nodes,
                                Boxed<Message>>;
  /// What a command of the text becomes.
  using CommandForm = std::function<std::string(std::string_view command)>;

  Message() = default;
  // NOLINTBEGIN(google-explicit-constructor)
  /// A text of the program. Only an array is one: what a pointer points to may not live as long.
  template <std::size_t size>
  Message(const char (&literal)[size]) : literal_(literal) {}
  template <std::size_t size>
  Message(char (&buffer)[size]) = delete;
  /// A text that was put together elsewhere.
  Message(std::string text);
  template <std::same_as<const char*> Pointer>
  Message(Pointer text) : Message(std::string(text)) {}
  Message(std::string_view text) : Message(std::string(text)) {}
  Message(Verbatim text);
  // NOLINTEND(google-explicit-constructor)
  /// `literal` as fmt reads it; it must outlive the message.
  Message(std::string_view literal, std::vector<Argument> arguments)
      : literal_(literal), arguments_(std::move(arguments)) {}

  bool empty() const { return literal_.empty(); }
  std::string_view literal() const { return literal_; }
  const std::vector<Argument>& arguments() const { return arguments_; }

  /// The sentence as it is, in the language of its literals.
  std::string text() const { return text(nullptr); }
  /// The same with this form for each command in the backticks of a literal.
  std::string text(const CommandForm& command) const;

  /// The message with another literal and other arguments, also of those within.
  Message changed(const std::function<std::string_view(std::string_view literal)>& literal,
                  const std::function<void(Argument&)>& argument) const;

  /// Whether a place, also of a message within, has this name: then it need not be put before.
  bool names(std::string_view name) const;

  /// Whether its text, also of a message within, has these words of the program: what stands at the places
  /// is not looked at.
  bool says(std::string_view words) const;

  bool operator==(const Message& other) const { return text() == other.text(); }

  /// The second after the first.
  friend Message operator+(const Message& first, const Message& second);
  Message& operator+=(const Message& more) { return *this = *this + more; }

 private:
  std::string_view literal_;
  std::vector<Argument> arguments_;
};

namespace message_details {

/// What fmt checks the placeholder of such a value against.
template <typename T>
using Shown = std::conditional_t<std::is_same_v<T, Message> || std::is_same_v<T, Verbatim> ||
                                     std::is_same_v<T, NameList> || std::is_same_v<T, Nodes>,
                                 std::string_view, T>;

template <typename T>
Message::Argument argument(const T& value) {
  if constexpr (std::is_same_v<T, Message>)
    return Boxed<Message>(value);
  else if constexpr (std::is_same_v<T, Verbatim> || std::is_same_v<T, NameList> || std::is_same_v<T, Nodes>)
    return value;
  else if constexpr (std::is_floating_point_v<T>)
    return static_cast<double>(value);
  else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool> && !std::is_same_v<T, char>) {
    if constexpr (std::is_signed_v<T>)
      return static_cast<std::int64_t>(value);
    else
      return static_cast<std::uint64_t>(value);
  } else if constexpr (std::is_array_v<T>)
    return Boxed<Message>(Message(value));
  else if constexpr (std::is_convertible_v<const T&, std::string_view>)
    return std::string(std::string_view(value));
  else
    return fmt::vformat("{}", fmt::make_format_args(value));
}

}  // namespace message_details

inline Nodes node_name(std::uint8_t number) { return {{number}}; }

template <typename Numbers>
Nodes node_names(const Numbers& numbers) {
  return {{numbers.begin(), numbers.end()}};
}

/// What a message shows as it is: Verbatim of a text, and numbers as they are.
template <typename T>
auto as_it_is(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>)
    return Verbatim{std::string(std::string_view(value))};
  else
    return value;
}

/// A message of a text and what stands at its placeholders, with the checks of fmt at compile time.
template <typename... Values>
Message message(fmt::format_string<message_details::Shown<std::decay_t<Values>>...> literal,
                const Values&... values) {
  static_assert(sizeof...(Values) > 0, "a text without placeholders is a message as it is");
  const fmt::string_view text = literal;
  return {std::string_view(text.data(), text.size()), {message_details::argument(values)...}};
}

/// The ending of a word or verb that is counted, which Chinese does not have.
template <std::size_t one_size, std::size_t more_size>
Message ending(std::size_t count, const char (&one)[one_size], const char (&more)[more_size]) {
  return count == 1 ? Message(one) : Message(more);
}
inline Message plural(std::size_t count) { return ending(count, "", "s"); }

}  // namespace servoctl
