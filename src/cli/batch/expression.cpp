#include "cli/batch/expression.hpp"

#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "cli/batch/result_path.hpp"

namespace servoctl::cli {
namespace {

struct Token {
  enum class Kind : std::uint8_t { end, word, quoted, comparator };
  Kind kind = Kind::end;
  std::string text;
};

struct Symbol {
  std::string_view text;
  Comparator comparator;
};
// Longer ones first: `<=` is not `<`.
constexpr Symbol kSymbols[] = {{"==", Comparator::equal},   {"!=", Comparator::unequal},
                               {"<=", Comparator::at_most}, {">=", Comparator::at_least},
                               {"<", Comparator::less},     {">", Comparator::greater},
                               {"~", Comparator::contains}};

constexpr std::string_view kExample = "for example: expect [0].value == 400 and .state == \"switched on\"";

std::string_view symbol(Comparator comparator) {
  for (const auto& known : kSymbols)
    if (known.comparator == comparator) return known.text;
  return "true";
}

class Lexer {
 public:
  Lexer(std::string_view text, const VariableLookup& variables) : text_(text), variables_(variables) {}

  Result<Token> next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    if (at_ == text_.size() || text_[at_] == '#') return Token{};
    for (const auto& known : kSymbols)
      if (text_.substr(at_).starts_with(known.text)) {
        at_ += known.text.size();
        return Token{Token::Kind::comparator, std::string(known.text)};
      }
    const char c = text_[at_];
    if (c == '"' || c == '\'') return quoted(c);
    if (c == '=') return fail(Errc::usage, "'=' compares nothing", "write ==");
    return word();
  }

 private:
  Result<void> take(std::string& out) {
    if (variables_.begins(text_, at_)) {
      const auto value = variables_.take(text_, at_);
      if (!value) return fail(value.error());
      out += *value;
    } else {
      out += text_[at_];
    }
    ++at_;
    return {};
  }

  Result<Token> quoted(char quote) {
    Token out{Token::Kind::quoted, {}};
    for (++at_; at_ < text_.size() && text_[at_] != quote;) {
      if (quote == '\'' || text_[at_] == '\\') {
        if (text_[at_] == '\\' && quote == '"' && at_ + 1 < text_.size()) ++at_;
        out.text += text_[at_++];
      } else if (const auto taken = take(out.text); !taken) {
        return fail(taken.error());
      }
    }
    if (at_ == text_.size()) return fail(Errc::usage, std::string("the quote ") + quote + " is not closed");
    ++at_;
    return out;
  }

  Result<Token> word() {
    Token out{Token::Kind::word, {}};
    while (at_ < text_.size() && std::string_view(" \t\"'=!<>~").find(text_[at_]) == std::string_view::npos)
      if (const auto taken = take(out.text); !taken) return fail(taken.error());
    // A lone `!` would never be passed.
    if (out.text.empty())
      return fail(Errc::usage, message("'{}' compares nothing", as_it_is(text_[at_])), std::string(kExample));
    return out;
  }

  std::string_view text_;
  VariableExpansion variables_;
  std::size_t at_ = 0;
};

Result<Operand> operand(const Token& token) {
  if (token.kind == Token::Kind::quoted) return Operand{Operand::Kind::quoted, token.text};
  if (token.kind != Token::Kind::word || token.text == "and")
    return fail(Errc::usage, "a value is missing in the expression", std::string(kExample));
  const auto checked = [](Operand::Kind kind, std::string path) -> Result<Operand> {
    if (const auto steps = parse_path(path); !steps) return fail(steps.error());
    return Operand{kind, std::move(path)};
  };
  const std::string_view text = token.text;
  if (text == "count") return Operand{Operand::Kind::count, "."};
  if (text.starts_with("count(")) {
    if (!text.ends_with(")")) return fail(Errc::usage, "the bracket of count( is not closed");
    return checked(Operand::Kind::count, std::string(text.substr(6, text.size() - 7)));
  }
  const bool number = parse_real(text).has_value();  // `.5`
  if (!number && (text.front() == '.' || text.front() == '['))
    return checked(Operand::Kind::path, token.text);
  return Operand{Operand::Kind::word, token.text};
}

Comparator comparator_of(const Token& token) {
  for (const auto& known : kSymbols)
    if (known.text == token.text) return known.comparator;
  return Comparator::holds;
}

std::string written(const Operand& operand) {
  switch (operand.kind) {
    case Operand::Kind::quoted: return report::to_json(operand.text);
    case Operand::Kind::count: return operand.text == "." ? "count" : "count(" + operand.text + ")";
    default: return operand.text;
  }
}

/// One side, as it is when it is compared.
struct Compared {
  std::string where;  ///< The path that leads to it; empty for what stands in the expression.
  report::Value value;
  bool word = false;  ///< A number or a text, as the other side is.
};

Result<std::vector<Compared>> sides(const Operand& operand, const report::Value& result) {
  if (operand.kind == Operand::Kind::word || operand.kind == Operand::Kind::quoted)
    return std::vector<Compared>{{{}, operand.text, operand.kind == Operand::Kind::word}};
  auto found = follow(result, operand.text);
  if (!found) return fail(found.error());
  std::vector<Compared> out;
  for (auto& part : *found) {
    if (operand.kind == Operand::Kind::path) {
      out.push_back({part.where, std::move(part.value)});
      continue;
    }
    const auto list = elements(part.value);
    if (!list) return fail(Errc::negative, message("{} is not a list and cannot be counted", part.where));
    out.push_back({part.where == "." ? "count" : "count(" + part.where + ")", list->size()});
  }
  return out;
}

std::optional<long double> number_of(const Compared& side) {
  if (side.word) {
    const auto& text = std::get<std::string>(side.value.data());
    if (const auto integer = parse_integer(text))
      return (integer->negative ? -1.0L : 1.0L) * static_cast<long double>(integer->magnitude);
    if (const auto real = parse_real(text)) return static_cast<long double>(*real);
    return std::nullopt;
  }
  return number(side.value);
}

bool is_integer(const Compared& side) {
  if (side.word) return parse_integer(std::get<std::string>(side.value.data())).has_value();
  const auto& data = side.value.data();
  return std::holds_alternative<std::int64_t>(data) || std::holds_alternative<std::uint64_t>(data) ||
         std::holds_alternative<report::Hex>(data);
}

/// A value in its unit is a product with the scale: its last digit is not exact. Integers are.
bool holds(long double a, Comparator comparator, long double b, bool exact) {
  const bool same = exact ? a == b : std::abs(a - b) <= 1e-12L * std::max(std::abs(a), std::abs(b));
  switch (comparator) {
    case Comparator::equal: return same;
    case Comparator::unequal: return !same;
    case Comparator::less: return a < b && !same;
    case Comparator::at_most: return a < b || same;
    case Comparator::greater: return a > b && !same;
    default: return a > b || same;
  }
}

bool contains(const Compared& left, const std::string& right) {
  const auto list = elements(left.value);
  if (!list) return text(left.value).find(right) != std::string::npos;
  return std::any_of(list->begin(), list->end(), [&](const auto& v) { return text(v) == right; });
}

Result<bool> compare(const Compared& left, Comparator comparator, const Compared& right) {
  if (comparator == Comparator::holds) return text(left.value) == "true";
  if (comparator == Comparator::contains) return contains(left, text(right.value));
  const auto a = number_of(left);
  const auto b = number_of(right);
  if (a && b) return holds(*a, comparator, *b, is_integer(left) && is_integer(right));
  if (comparator == Comparator::equal) return text(left.value) == text(right.value);
  if (comparator == Comparator::unequal) return text(left.value) != text(right.value);
  const auto& wrong = a ? right : left;
  return fail(Errc::negative,
              message("{}{} is not a number: {} cannot compare it", wrong.where,
                      wrong.where.empty() ? text(wrong.value) : " (" + report::to_json(wrong.value) + ")",
                      symbol(comparator)));
}

std::string shown(const Compared& side) { return side.word ? text(side.value) : report::to_json(side.value); }

tl::unexpected<Error> refuted(const Compared& left, Comparator comparator, const Compared& right) {
  if (comparator == Comparator::holds)
    return fail(Errc::negative, message("{} is {}, expected true", left.where, shown(left)));
  const auto expected =
      (comparator == Comparator::contains ? std::string("~") : std::string(symbol(comparator))) + " " +
      (right.where.empty() ? "" : right.where + " = ") + shown(right);
  return fail(Errc::negative, left.where.empty()
                                  ? message("{} {} is not true", shown(left), expected)
                                  : message("{} is {}, expected {}", left.where, shown(left), expected));
}

}  // namespace

Result<Expression> parse_expression(std::string_view text, const VariableLookup& variables) {
  Lexer lexer(text, variables);
  Expression out;
  for (;;) {
    auto token = lexer.next();
    if (!token) return fail(token.error());
    auto left = operand(*token);
    if (!left) return fail(left.error());
    out.push_back({std::move(*left)});
    token = lexer.next();
    if (token && token->kind == Token::Kind::comparator) {
      out.back().comparator = comparator_of(*token);
      const auto right_token = lexer.next();
      if (!right_token) return fail(right_token.error());
      auto right = operand(*right_token);
      if (!right) return fail(right.error());
      out.back().right = std::move(*right);
      token = lexer.next();
    }
    if (!token) return fail(token.error());
    if (token->kind == Token::Kind::end) return out;
    if (token->kind != Token::Kind::word || token->text != "and")
      return fail(Errc::usage, message("'{}' does not belong here", as_it_is(token->text)),
                  "join comparisons with `and`; put text with blanks in quotes");
  }
}

std::string to_string(const Expression& expression) {
  std::string out;
  for (const auto& comparison : expression) {
    append(out, written(comparison.left), " and ");
    if (comparison.comparator != Comparator::holds)
      out += formatted(" {} {}", symbol(comparison.comparator), written(comparison.right));
  }
  return out;
}

Result<void> expect(const Expression& expression, const report::Value& result) {
  for (const auto& comparison : expression) {
    const auto left = sides(comparison.left, result);
    if (!left) return fail(left.error());
    const auto right = sides(comparison.right, result);
    if (!right) return fail(right.error());
    for (const auto& a : *left)
      for (const auto& b : *right) {
        const auto answer = compare(a, comparison.comparator, b);
        if (!answer) return fail(answer.error());
        if (!*answer) return refuted(a, comparison.comparator, b);
      }
  }
  return {};
}

}  // namespace servoctl::cli
