#include "report/value.hpp"

namespace servoctl::report {

Value::Value() = default;
Value::Value(const Value&) = default;
Value::Value(Value&&) noexcept = default;
Value& Value::operator=(const Value&) = default;
Value& Value::operator=(Value&&) noexcept = default;
Value::~Value() = default;

Value::Value(const char* text) : data_(std::string(text)) {}
Value::Value(std::string_view text) : data_(std::string(text)) {}
Value::Value(std::string text) : data_(std::move(text)) {}
Value::Value(double number) : data_(number) {}
Value::Value(Hex number) : data_(number) {}
Value::Value(List list) : data_(std::move(list)) {}
Value::Value(Record record) : data_(std::move(record)) {}
Value::Value(Table table) : data_(std::move(table)) {}
Value::Value(Plot plot) : data_(std::move(plot)) {}
Value::Value(Written json) : data_(std::move(json)) {}

}  // namespace servoctl::report
