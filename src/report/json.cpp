#include <cmath>
#include <nlohmann/json.hpp>

#include "report/value.hpp"

namespace servoctl::report {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Value& value);

struct ToJson {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(bool b) const { return b; }
  Json operator()(std::int64_t i) const { return i; }
  Json operator()(std::uint64_t u) const { return u; }
  Json operator()(double d) const {
    // A whole number is written without ".0", so that 40 Hz reads 40 as in text.
    if (d == std::floor(d) && std::abs(d) < 9.0e15) return static_cast<std::int64_t>(d);
    return d;
  }
  Json operator()(const std::string& s) const { return s; }
  Json operator()(const Hex& h) const { return h.value; }
  Json operator()(const List& l) const {
    Json out = Json::array();
    for (const auto& v : l) out.push_back(json(v));
    return out;
  }
  Json operator()(const Record& r) const {
    Json out = Json::object();
    for (const auto& field : r)
      if (field.show != Show::text) out[field.key] = json(field.value);
    return out;
  }
  Json operator()(const Table& t) const {
    Json out = Json::array();
    for (const auto& row : t.rows) {
      Json object = Json::object();
      for (std::size_t i = 0; i < row.size(); ++i)
        if (t.columns[i].show != Show::text) object[t.columns[i].key] = json(row[i]);
      out.push_back(std::move(object));
    }
    return out;
  }
};

Json json(const Value& value) { return std::visit(ToJson{}, value.data()); }

}  // namespace

std::string to_json(const Value& value) {
  // Names come from files and drives: a byte that is no UTF-8 becomes U+FFFD instead of an exception.
  return json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace servoctl::report
