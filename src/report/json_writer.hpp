#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace servoctl::report {

class Value;

/// Writes one line of JSON at the end of a text, piece by piece: what there are millions of needs no tree of
/// values. Commas come by themselves; the text must be empty, or end with a line break or with such a piece.
/// Numbers and texts are those of to_json(), which is made of this.
class JsonWriter {
 public:
  /// `out` outlives the writer.
  explicit JsonWriter(std::string& out) : out_(&out) {}

  void begin_record() { begin('{'); }
  void end_record() { *out_ += '}'; }
  void begin_list() { begin('['); }
  void end_list() { *out_ += ']'; }

  /// The key of the value, record or list that is written next.
  void key(std::string_view key);

  void null() { written("null"); }
  template <class T>
  requires std::is_integral_v<T>
  void value(T number) {
    if constexpr (std::is_same_v<T, bool>)
      written(number ? "true" : "false");
    else if constexpr (std::is_signed_v<T>)
      integer(number);
    else
      natural(number);
  }
  /// A whole number is written without ".0", so that 40 Hz reads 40 as in text; null where it is no number.
  void value(double number);
  /// A byte that is no UTF-8 becomes U+FFFD; what is not printable() is written as an escape.
  void value(std::string_view text);
  void value(const std::string& text) { value(std::string_view(text)); }
  void value(const char* text) { value(std::string_view(text)); }
  /// Null where there is nothing.
  template <class T>
  void value(const std::optional<T>& some) {
    some ? value(*some) : null();
  }
  template <class T>
  requires std::is_same_v<T, Value>
  void value(const T& tree) { write(tree); }

  /// What has been written as JSON before: a value, or members of a record with commas between them.
  void written(std::string_view json);

  /// A member of a record; its name stands in our code, and needs no escape.
  template <std::size_t n, class T>
  void member(const char (&name)[n], const T& member) {
    quoted({name, n - 1}, "\":");
    value(member);
  }
  template <std::size_t n>
  void text_or_null(const char (&name)[n], std::string_view text) {
    quoted({name, n - 1}, "\":");
    text.empty() ? null() : value(text);
  }

 private:
  void write(const Value& tree);
  /// The last character tells: within a text it is always the quotation mark at its end.
  bool needs_comma() const {
    if (out_->empty()) return false;
    const char last = out_->back();
    return last != '{' && last != '[' && last != ':' && last != '\n';
  }
  void begin(char first);
  void quoted(std::string_view text, std::string_view end);
  void integer(std::int64_t number);
  void natural(std::uint64_t number);

  std::string* out_;
};

}  // namespace servoctl::report
