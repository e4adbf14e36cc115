#include "drive/rules.hpp"

#include <fmt/format.h>
#include <functional>
#include <utility>

#define TOML_HEADER_ONLY 1  // The shared library is built with exceptions.
#define TOML_EXCEPTIONS 0
// toml++ 3.3 asserts (or, without assertions, assumes) of a key what its input need not hold: "[=]". The code
// behind it reports the error in order.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

#include "base/number.hpp"

namespace servoctl::drive {
namespace {

/// Reads one table key by key; remembers the first thing that is wrong.
class Reader {
 public:
  Reader(const toml::table& table, std::string_view file) : table_(&table), file_(file) {}

  using Handler = std::function<bool(const toml::node&)>;

  /// Every key must be one of these; a handler answers whether it could use the value.
  Result<void> read(const std::map<std::string_view, Handler>& handlers) const {
    for (const auto& [key, node] : *table_) {
      const auto handler = handlers.find(std::string_view(key.str()));
      if (handler == handlers.end()) return fail_at(node, fmt::format("unknown key '{}'", key.str()));
      if (!handler->second(node))
        return fail_at(node, fmt::format("the value of '{}' is of the wrong kind", key.str()));
    }
    return {};
  }

  tl::unexpected<Error> fail_at(const toml::node& node, const std::string& what) const {
    Error error;
    error.code = Errc::file;
    error.line = node.source().begin.line;
    error.message = fmt::format("{}:{}:{}: {}", file_, *error.line, node.source().begin.column, what);
    return fail(std::move(error));
  }

 private:
  const toml::table* table_;
  std::string_view file_;
};

bool get(const toml::node& node, std::string& out) {
  const auto value = node.value_exact<std::string>();
  if (value) out = *value;
  return value.has_value();
}

bool get(const toml::node& node, bool& out) {
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

bool get(const toml::node& node, ObjectAddress& out) {
  std::string text;
  const auto address = get(node, text) ? parse_object_address(text) : std::nullopt;
  if (address) out = *address;
  return address.has_value();
}

bool get(const toml::node& node, Condition& out) {
  const auto* table = node.as_table();
  if (table == nullptr || table->size() != 2) return false;
  const auto* object = table->get("object");
  const auto* value = table->get("value");
  return object != nullptr && value != nullptr && get(*object, out.object) && get_int(*value, out.value);
}

bool get(const toml::node& node, ModeBits& out) {
  const auto* table = node.as_table();
  if (table == nullptr || table->size() != 3) return false;
  const auto* mode = table->get("mode");
  const auto* disabled = table->get("disabled");
  const auto* enabled = table->get("enabled");
  return mode != nullptr && disabled != nullptr && enabled != nullptr && get_int(*mode, out.mode) &&
         get_int(*disabled, out.disabled) && get_int(*enabled, out.enabled);
}

bool get(const toml::node& node, std::int64_t& out) { return get_int(node, out); }

template <class T>
bool get(const toml::node& node, std::vector<T>& out) {
  const auto* array = node.as_array();
  if (array == nullptr) return false;
  for (const auto& element : *array) {
    out.emplace_back();
    if (!get(element, out.back())) return false;
  }
  return true;
}

class RulesReader {
 public:
  explicit RulesReader(std::string_view file) : file_(file) {}

  Result<Rules> read(const toml::table& root) {
    std::int64_t format = 0;
    const auto done =
        Reader(root, file_)
            .read({
                {"format", [&](const auto& n) { return get_int(n, format) && format == 1; }},
                {"family", [&](const auto& n) { return get(n, rules_.family); }},
                {"vendor", [&](const auto& n) { return get(n, rules_.vendor); }},
                {"name", [&](const auto& n) { return get(n, rules_.name); }},
                {"name_zh", [&](const auto& n) { return get(n, rules_.name_zh); }},
                {"identity", [&](const auto& n) { return table(n, &RulesReader::identity); }},
                {"numbering", [&](const auto& n) { return table(n, &RulesReader::numbering); }},
                {"sdo", [&](const auto& n) { return table(n, &RulesReader::sdo); }},
                {"nmt", [&](const auto& n) { return table(n, &RulesReader::nmt); }},
                {"mirror", [&](const auto& n) { return table(n, &RulesReader::mirror); }},
                {"restart", [&](const auto& n) { return table(n, &RulesReader::restart); }},
                {"statusword", [&](const auto& n) { return table(n, &RulesReader::statusword); }},
                {"quick_stop", [&](const auto& n) { return table(n, &RulesReader::quick_stop); }},
                {"fault_reset", [&](const auto& n) { return table(n, &RulesReader::fault_reset); }},
                {"emergency", [&](const auto& n) { return table(n, &RulesReader::emergency); }},
                {"abort_codes", [&](const auto& n) { return abort_codes(n); }},
            });
    if (inner_) return tl::unexpected<Error>(*inner_);
    if (!done) return tl::unexpected<Error>(done.error());
    if (format == 0 || rules_.family.empty())
      return fail(Errc::file, fmt::format("{}: 'format' or 'family' is missing", file_),
                  "begin the file with format = 1 and family = \"NAME\"");
    return std::move(rules_);
  }

 private:
  using Section = Result<void> (RulesReader::*)(const Reader&);

  /// Reads a sub-table; its own error, with its own line, goes before "of the wrong kind".
  bool table(const toml::node& node, Section section) {
    const auto* inside = node.as_table();
    if (inside == nullptr) return false;
    const auto done = (this->*section)(Reader(*inside, file_));
    if (!done && !inner_) inner_ = done.error();
    return done.has_value();
  }

  Result<void> identity(const Reader& reader) {
    return reader.read({{"certain", [&](const auto& n) { return get(n, rules_.identity_certain); }},
                        {"match", [&](const auto& n) { return get(n, rules_.identity); }}});
  }

  Result<void> numbering(const Reader& reader) {
    auto& out = rules_.numbering.emplace();
    return reader.read({{"prefix", [&](const auto& n) { return get(n, out.prefix); }},
                        {"index", [&](const auto& n) { return get_int(n, out.index); }},
                        {"block", [&](const auto& n) { return get_int(n, out.block) && out.block > 0; }},
                        {"first_sub", [&](const auto& n) { return get_int(n, out.first_sub); }}});
  }

  Result<void> sdo(const Reader& reader) {
    return reader.read({{"segmented", [&](const auto& n) { return get(n, rules_.sdo_segmented); }},
                        {"block", [&](const auto& n) { return get(n, rules_.sdo_block); }},
                        {"exact_length", [&](const auto& n) { return get(n, rules_.sdo_exact_length); }}});
  }

  Result<void> nmt(const Reader& reader) {
    return reader.read(
        {{"node_id", [&](const auto& n) { return get(n, rules_.node_id_parameter); }},
         {"bitrate", [&](const auto& n) { return get(n, rules_.bitrate_parameter); }},
         {"autostart", [&](const auto& n) { return get(n, rules_.autostart_parameter); }},
         {"guarding_alarm", [&](const auto& n) { return get(n, rules_.guarding_alarm_parameter); }},
         {"max_nodes", [&](const auto& n) { return get_int(n, rules_.max_nodes); }}});
  }

  Result<void> mirror(const Reader& reader) {
    return reader.read({{"add_node_id", [&](const auto& n) { return get(n, rules_.mirror_add_node_id); }}});
  }

  Result<void> restart(const Reader& reader) {
    return reader.read(
        {{"restore_defaults", [&](const auto& n) { return get(n, rules_.restore_defaults_parameter); }},
         {"clear_alarms", [&](const auto& n) { return get(n, rules_.clear_alarms_parameter); }}});
  }

  Result<void> statusword(const Reader& reader) {
    const auto word = [&](DriveState state) {
      return [this, state](const toml::node& n) {
        return get_int(n, rules_.statusword[static_cast<std::size_t>(state)]);
      };
    };
    return reader.read({{"not_ready_to_switch_on", word(DriveState::not_ready_to_switch_on)},
                        {"switch_on_disabled", word(DriveState::switch_on_disabled)},
                        {"ready_to_switch_on", word(DriveState::ready_to_switch_on)},
                        {"switched_on", word(DriveState::switched_on)},
                        {"operation_enabled", word(DriveState::operation_enabled)},
                        {"quick_stop_active", word(DriveState::quick_stop_active)},
                        {"fault_reaction_active", word(DriveState::fault_reaction_active)},
                        {"fault", word(DriveState::fault)},
                        {"mode_bits", [&](const auto& n) { return get(n, rules_.mode_bits); }}});
  }

  Result<void> quick_stop(const Reader& reader) {
    return reader.read(
        {{"stays_enabled", [&](const auto& n) { return get(n, rules_.quick_stop_stays_enabled); }}});
  }

  Result<void> fault_reset(const Reader& reader) {
    return reader.read({{"enabled_by", [&](const auto& n) {
                           Condition condition;
                           if (!get(n, condition)) return false;
                           rules_.fault_reset_enabled_by = condition;
                           return true;
                         }}});
  }

  Result<void> emergency(const Reader& reader) {
    return reader.read({{"drive_alarm", [&](const auto& n) { return get_int(n, rules_.drive_alarm_code); }}});
  }

  bool abort_codes(const toml::node& node) {
    const auto* inside = node.as_table();
    if (inside == nullptr) return false;
    for (const auto& [key, value] : *inside) {
      const auto code = parse_integer(std::string_view(key.str()));
      std::string text;
      if (!code || code->negative || code->magnitude > 0xFFFF'FFFFU || !get(value, text)) return false;
      rules_.abort_texts_zh.emplace(static_cast<std::uint32_t>(code->magnitude), std::move(text));
    }
    return true;
  }

  std::string_view file_;
  Rules rules_;
  std::optional<Error> inner_;
};

}  // namespace

Result<Rules> parse_rules(std::string_view toml, std::string_view file) {
  const auto parsed = toml::parse(toml, file);
  if (!parsed) {
    const auto& problem = parsed.error();
    Error error;
    error.code = Errc::file;
    error.line = problem.source().begin.line;
    error.message = fmt::format("{}:{}:{}: {}", file, *error.line, problem.source().begin.column,
                                std::string_view(problem.description()));
    return fail(std::move(error));
  }
  return RulesReader(file).read(parsed.table());
}

}  // namespace servoctl::drive
