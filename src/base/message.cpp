#include "base/message.hpp"

#include <fmt/args.h>
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl {
namespace {

using Values = fmt::dynamic_format_arg_store<fmt::format_context>;

/// Words before nodes, which go where the first has a name.
constexpr std::array<std::string_view, 3> kLeads{"nodes ", "node ", "节点 "};

bool is_figure(char c) { return c >= '0' && c <= '9'; }

/// A format string piece by piece, each placeholder with its number.
class Writer {
 public:
  Writer(const Message& message, const Message::CommandForm& command)
      : message_(&message), command_(&command), formats_(!message.arguments().empty()) {
    for (const auto& one : message.arguments()) std::visit([this](const auto& value) { add(value); }, one);
  }

  std::string all() {
    const auto text = message_->literal();
    for (std::size_t at = 0; at < text.size();) {
      const char c = text[at];
      if (c == '`' && *command_) {
        turn_at(text.substr(at + 1).find('`') != std::string_view::npos);
        ++at;
      } else if (c == '{' && formats_ && !text.substr(at).starts_with("{{")) {
        at += place(text.substr(at));
      } else {
        // Between Chinese and Chinese there is no blank.
        const bool is_needless =
            c == ' ' && is_beside_ && ends_in_chinese(piece_) && begins_in_chinese(text.substr(at + 1));
        at += formats_ && (c == '{' || c == '}') ? 2 : 1;
        if (!is_needless) piece_ += c;
        is_beside_ = false;
      }
    }
    return std::move(out_ += piece_);
  }

 private:
  void add(const Verbatim& value) { values_.push_back(value.text); }
  void add(const NameList& value) { values_.push_back(value.text(", ")); }
  void add(const Nodes& value) { values_.push_back(value.text()); }
  void add(const Boxed<Message>& value) { values_.push_back(value.get()->text(*command_)); }
  template <typename T>
  void add(const T& value) {
    values_.push_back(value);
  }

  /// A backtick: before it is text, or a command.
  void turn_at(bool more) {
    out_ += begun_ ? (*command_)(piece_) : piece_;
    out_ += '`';
    begun_ = !begun_ && more;
    piece_.clear();
  }

  /// The placeholder that begins here; its size.
  std::size_t place(std::string_view text) {
    std::string out = "{";
    std::size_t at = 1;
    std::size_t index = 0;
    const auto number = [&] {
      const auto begin = at;
      while (at < text.size() && is_figure(text[at])) ++at;
      index = 0;
      for (const char c : text.substr(begin, at - begin))
        index = index * 10 + static_cast<std::size_t>(c - '0');
      if (begin == at) index = next_++;
      out += std::to_string(index);
    };
    number();
    const auto value = index;
    while (at < text.size() && text[at] != '}') {
      out += text[at];
      if (text[at++] != '{') continue;
      number();
      out += '}';
      ++at;
    }
    call_by_name(value);
    const auto shown = fmt::vformat(out + "}", values_);
    if (!is_beside_ && piece_.ends_with(' ') && begins_in_chinese(shown) &&
        ends_in_chinese(std::string_view(piece_).substr(0, piece_.size() - 1)))
      piece_.pop_back();
    piece_ += shown;
    is_beside_ = true;
    return at + 1;
  }

  /// `node` goes before a name.
  void call_by_name(std::size_t index) {
    if (index >= message_->arguments().size()) return;
    const auto* nodes = std::get_if<Nodes>(&message_->arguments()[index]);
    if (nodes == nullptr || nodes->names.empty() || nodes->names.front().empty()) return;
    for (const auto lead : kLeads) {
      if (!piece_.ends_with(lead)) continue;
      piece_.resize(piece_.size() - lead.size());
      // Between Chinese and a name is a blank, as between Chinese and the number.
      if (ends_with_character(piece_)) piece_ += ' ';
      return;
    }
  }

  const Message* message_;
  const Message::CommandForm* command_;
  bool formats_;  ///< A text without arguments has no placeholders either.
  Values values_;
  std::string out_;
  std::string piece_;
  std::size_t next_ = 0;
  bool is_beside_ = false;  ///< The last piece is a value.
  bool begun_ = false;
};

}  // namespace

std::string Nodes::text() const {
  std::string out;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    append(out, i < names.size() && !names[i].empty() ? names[i] : std::to_string(numbers[i]), ", ");
  return out;
}

std::string NameList::text(std::string_view between) const {
  std::string out;
  for (const auto& word : words) append(out, word, between);
  return out;
}

Message::Message(std::string text) {
  if (text.empty()) return;
  literal_ = "{}";
  arguments_.emplace_back(std::move(text));
}

Message::Message(Verbatim text) {
  if (text.text.empty()) return;
  literal_ = "{}";
  arguments_.emplace_back(std::move(text));
}

bool Message::names(std::string_view name) const {
  const auto has = [name](std::string_view text) { return text.find(name) != std::string_view::npos; };
  return std::any_of(arguments_.begin(), arguments_.end(), [&](const Argument& one) {
    if (const auto* inner = std::get_if<Boxed<Message>>(&one)) return inner->get()->names(name);
    if (const auto* text = std::get_if<std::string>(&one)) return has(*text);
    if (const auto* text = std::get_if<Verbatim>(&one)) return has(text->text);
    if (const auto* list = std::get_if<NameList>(&one))
      return std::any_of(list->words.begin(), list->words.end(), has);
    const auto* nodes = std::get_if<Nodes>(&one);
    return nodes != nullptr && std::any_of(nodes->names.begin(), nodes->names.end(), has);
  });
}

bool Message::says(std::string_view words) const {
  return literal_.find(words) != std::string_view::npos ||
         std::any_of(arguments_.begin(), arguments_.end(), [words](const Argument& one) {
           const auto* inner = std::get_if<Boxed<Message>>(&one);
           return inner != nullptr && inner->get()->says(words);
         });
}

Message operator+(const Message& first, const Message& second) {
  if (first.empty()) return second;
  if (second.empty()) return first;
  return {"{}{}", {Boxed<Message>(first), Boxed<Message>(second)}};
}

std::string Message::text(const CommandForm& command) const { return Writer(*this, command).all(); }

Message Message::changed(const std::function<std::string_view(std::string_view literal)>& literal,
                         const std::function<void(Argument&)>& argument) const {
  auto out = *this;
  out.literal_ = literal(literal_);
  for (auto& one : out.arguments_) {
    if (auto* inner = std::get_if<Boxed<Message>>(&one))
      *inner = Boxed<Message>(inner->get()->changed(literal, argument));
    else
      argument(one);
  }
  return out;
}

}  // namespace servoctl
