#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "report/value.hpp"

namespace servoctl::show {

/// Reads the fields of a record; remembers the first that is missing or of another kind.
class FieldReader {
 public:
  FieldReader(const report::Value& record, Message where) : record_(&record), where_(std::move(where)) {}

  std::string text(std::string_view key, bool required = false) {
    return read<std::string>(key, required).value_or(std::string());
  }
  std::optional<std::uint64_t> number(std::string_view key, bool required = false) {
    return read<std::uint64_t>(key, required);
  }
  bool flag(std::string_view key) { return read<bool>(key, true).value_or(false); }
  void refuse(std::string_view key) {
    if (!error_) error_ = message("{}: '{}' is missing or wrong", where_, as_it_is(key));
  }
  const std::optional<Message>& error() const { return error_; }

 private:
  template <class T>
  std::optional<T> read(std::string_view key, bool required) {
    const auto* value = report::find(*record_, key);
    const auto* out = value == nullptr ? nullptr : std::get_if<T>(&value->data());
    if (out == nullptr && (required || (value != nullptr && !value->is_null()))) refuse(key);
    return out == nullptr ? std::nullopt : std::optional<T>(*out);
  }

  const report::Value* record_;
  Message where_;
  std::optional<Message> error_;
};

}  // namespace servoctl::show
