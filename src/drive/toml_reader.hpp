#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// What is not a template is compiled once, in toml_inside.cpp: it took a file half a minute. The shared
// library is built with exceptions.
#define TOML_HEADER_ONLY 0
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0  // Nothing is written.
// toml++ 3.3 asserts (or, without assertions, assumes) of a key what its input need not hold: "[=]". The code
// behind it reports the error in order.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

#include "base/format.hpp"
#include "base/object_address.hpp"
#include "base/offer.hpp"
#include "base/result.hpp"
#include "base/text.hpp"

/// Reads TOML tables whose every key is known. Each get() answers whether the node was of its kind.
namespace servoctl::drive {

inline bool get(const toml::node& node, std::string& out) {
  const auto value = node.value_exact<std::string>();
  if (value) out = *value;
  return value.has_value();
}

inline bool get(const toml::node& node, bool& out) {
  const auto value = node.value_exact<bool>();
  if (value) out = *value;
  return value.has_value();
}

template <class Int>
bool get_int(const toml::node& node, Int& out) {
  const auto value = node.value_exact<std::int64_t>();
  if (!value || !std::in_range<Int>(*value)) return false;
  out = static_cast<Int>(*value);
  return true;
}

inline bool get(const toml::node& node, std::uint8_t& out) { return get_int(node, out); }
inline bool get(const toml::node& node, std::int8_t& out) { return get_int(node, out); }
inline bool get(const toml::node& node, std::uint16_t& out) { return get_int(node, out); }
inline bool get(const toml::node& node, std::uint32_t& out) { return get_int(node, out); }
inline bool get(const toml::node& node, std::uint64_t& out) { return get_int(node, out); }
inline bool get(const toml::node& node, std::int64_t& out) { return get_int(node, out); }

inline bool get(const toml::node& node, ObjectAddress& out) {
  std::string text;
  const auto address = get(node, text) ? parse_object_address(text) : std::nullopt;
  if (address) out = *address;
  return address.has_value();
}

template <class T>
bool get(const toml::node& node, std::optional<T>& out) {
  T value{};
  if (!get(node, value)) return false;
  out = std::move(value);
  return true;
}

/// Reads a list; the elements' get() is found where the caller stands.
template <class T, class Get>
bool get_list(const toml::node& node, std::vector<T>& out, Get get_one) {
  const auto* array = node.as_array();
  if (array == nullptr) return false;
  out.clear();
  for (const auto& element : *array) {
    out.emplace_back();
    if (!get_one(element, out.back())) return false;
  }
  return true;
}

template <class T>
bool get(const toml::node& node, std::vector<T>& out) {
  return get_list(node, out, [](const toml::node& n, T& o) { return get(n, o); });
}

/// A table with exactly these keys, in any order.
inline bool has_only(const toml::node& node, std::initializer_list<std::string_view> keys) {
  const auto* table = node.as_table();
  if (table == nullptr || table->size() != keys.size()) return false;
  for (const auto key : keys)
    if (table->get(key) == nullptr) return false;
  return true;
}

/// The value of a key that the table has.
inline const toml::node& at(const toml::node& node, std::string_view key) {
  return *node.as_table()->get(key);
}

/// What stands there, for a message: a plain value as it is, at most its first 40 bytes.
inline std::string value_in_words(const toml::node& node) {
  constexpr std::size_t kMost = 40;
  std::string text;
  if (const auto whole = node.value_exact<std::int64_t>()) return formatted("{}", *whole);
  if (const auto number = node.value_exact<double>()) return formatted("{}", *number);
  if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
  if (get(node, text))
    return text.size() > kMost ? formatted("a text of {} bytes", text.size()) : formatted("\"{}\"", text);
  return node.is_table() ? "a table" : node.is_array() ? "this list" : "a date or time";
}

/// How a value that get() reads into `T` is written; empty where nobody could tell in a few words.
template <class T>
constexpr std::string_view form_of() {
  if constexpr (std::is_same_v<T, bool>) return "true or false";
  if constexpr (std::is_same_v<T, std::string>) return "a text in quotes";
  if constexpr (std::is_same_v<T, ObjectAddress>) return R"(an object: "0x6041:00")";
  if constexpr (std::is_same_v<T, std::int8_t>) return "a whole number from -128 to 127";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "a whole number from 0 to 255";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "a whole number from 0 to 0xFFFF";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "a whole number from 0 to 0xFFFFFFFF";
  if constexpr (std::is_same_v<T, std::int64_t>) return "a whole number";
  if constexpr (std::is_same_v<T, std::vector<std::string>>) return R"(a list of texts: ["P1-01", "P1-02"])";
  if constexpr (std::is_same_v<T, std::vector<ObjectAddress>>) return R"(a list of objects: ["0x6041:00"])";
  if constexpr (std::is_same_v<T, std::vector<std::int64_t>> || std::is_same_v<T, std::vector<std::uint16_t>>)
    return "a list of whole numbers: [1, 2]";
  return {};
}

/// Reads one table key by key. Without a list for errors it stops at the first that is wrong; with one it
/// adds all of them to it.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string_view file, std::vector<Error>* errors = nullptr)
      : table_(&table), file_(file), errors_(errors) {}

  /// Answers whether it could use the value of a key, and knows how that is written.
  class Handler {
   public:
    template <class Read>
    requires(!std::is_same_v<std::remove_cvref_t<Read>, Handler>)
        // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload): stands in
        // lists.
        Handler(Read&& read, std::string_view form = {})
        : read_(std::forward<Read>(read)), form_(form) {}
    bool operator()(const toml::node& node) const { return read_(node); }
    std::string_view form() const { return form_; }

   private:
    std::function<bool(const toml::node&)> read_;
    std::string_view form_;
  };
  using Handlers = std::map<std::string_view, Handler>;
  /// How the value of a key is written, for the hint where it is not; before what its handler says.
  using Forms = std::map<std::string_view, std::string_view>;

  /// Every key must be one of these; a handler answers whether it could use the value. The first error.
  Result<void> read(const Handlers& handlers, const Forms& forms = {}) const {
    Result<void> out;
    for (const auto& [key, node] : *table_) {
      const auto handler = handlers.find(std::string_view(key.str()));
      auto done = handler == handlers.end() ? Result<void>(unknown(key, handlers))
                                            : read_key(key, node, handler->second, forms);
      if (out && !done) out = std::move(done);
      if (!out && errors_ == nullptr) return out;
    }
    return out;
  }

  tl::unexpected<Error> fail_at(const toml::node& node, const Message& what, Message hint = {}) const {
    const auto at = node.source().begin;
    return noted(file_error(file_, at.line, at.column, what), std::move(hint));
  }

  std::string_view file() const { return file_; }

 private:
  static constexpr std::size_t kMostOffered = 30;

  Result<void> read_key(const toml::key& key, const toml::node& node, const Handler& handler,
                        const Forms& forms) const {
    if (handler(node)) return {};
    const auto given = forms.find(std::string_view(key.str()));
    const auto form = given == forms.end() ? handler.form() : given->second;
    return fail_at(node, message("'{}' cannot be {}", as_it_is(key.str()), value_in_words(node)),
                   form.empty() ? Message() : message("write {}", form));
  }

  tl::unexpected<Error> unknown(const toml::key& key, const Handlers& handlers) const {
    const auto at = key.source().begin;
    std::vector<std::string> known;
    for (const auto& handler : handlers) known.emplace_back(handler.first);
    auto hint = did_you_mean(key.str(), known);
    if (hint.empty() && known.size() <= kMostOffered) hint = "write one of " + one_of(known);
    return noted(file_error(file_, at.line, at.column, message("unknown key '{}'", as_it_is(key.str()))),
                 std::move(hint));
  }

  tl::unexpected<Error> noted(Error error, Message hint) const {
    error.hint = std::move(hint);
    if (errors_ != nullptr) errors_->push_back(error);
    return fail(std::move(error));
  }

  const toml::table* table_;
  std::string_view file_;
  std::vector<Error>* errors_;
};

/// A handler that reads the value into `out`.
template <class T>
TableReader::Handler into(T& out) {
  return {[&out](const toml::node& node) { return get(node, out); }, form_of<T>()};
}
template <class T>
TableReader::Handler into(std::optional<T>& out) {
  return {[&out](const toml::node& node) { return get(node, out); }, form_of<T>()};
}

}  // namespace servoctl::drive
