#include "drive/rules.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/provenance.hpp"
#include "drive/rules_reader.hpp"
#include "drive/toml_depth.hpp"

namespace servoctl::drive {
namespace {

class RulesReader {
 public:
  RulesReader(std::string_view file, Rules base, std::vector<Error>& errors)
      : file_(file), rules_(std::move(base)), errors_(&errors) {
    // What a family is called and how it is recognised is its own.
    rules_.family.clear();
    rules_.identity.clear();
    rules_.identity_certain = false;
    rules_.identity_telling = false;
    rules_.identity_looks.clear();
  }

  Rules read(const toml::table& root) {
    std::int64_t format = 0;
    const auto before = errors_->size();
    (void)TableReader(root, file_, errors_)
        .read({
            {"format", [&](const auto& n) { return get_int(n, format) && format == 1; }},
            {"family", into(rules_.family)},
            {"parent", into(rules_.parent)},
            {"vendor", into(rules_.vendor)},
            {"name", into(rules_.name)},
            {"name_zh", into(rules_.name_zh)},
            {"provenance", [&](const auto& n) { return provenance(n); }},
            {"identity", section(read_identity)},
            {"numbering", tables(rules_.numbering, read_numbering)},
            {"units", section(read_units)},
            {"sdo", section(read_sdo)},
            {"nmt", section(read_nmt)},
            {"pdo", section(read_pdo)},
            {"coe", section(read_coe)},
            {"modbus", section(read_modbus)},
            {"store", section(read_store)},
            {"restart", section(read_restart)},
            {"mirror", section(read_mirror)},
            {"statusword", section(read_statusword)},
            {"quick_stop", section(read_quick_stop)},
            {"motion", section(read_motion)},
            {"emergency", section(read_emergency)},
            {"fault", section(read_fault)},
            {"caution", tables(rules_.cautions, read_caution)},
            {"abort_codes", [&](const auto& n) { return abort_codes(n); }},
            {"assumed", into(rules_.assumed)},
            {"contradicted", [&](const auto& n) { return contradicted(n); }},
        });
    const bool misses = root.get("format") == nullptr || rules_.family.empty();
    if (misses && errors_->size() == before)
      errors_->push_back(make_error(Errc::file,
                                    message("{}: 'format' or 'family' is missing", as_it_is(file_)),
                                    "begin the file with format = 1 and family = \"NAME\""));
    if (rules_.is_assumed("motion.inputs_active_low")) rules_.motion.inputs_known = true;
    return std::move(rules_);
  }

 private:
  using Handler = TableReader::Handler;

  /// What is wrong inside of a section goes into the list of errors, with its own line.
  Handler section(Result<void> (*parse)(const TableReader&, Rules&)) {
    return {[this, parse](const toml::node& node) {
              const auto* inside = node.as_table();
              if (inside != nullptr) (void)parse(TableReader(*inside, file_, errors_), rules_);
              return inside != nullptr;
            },
            "it as a section: [NAME]"};
  }

  /// Kept by nobody: provenance_of() reads it when it is asked for.
  bool provenance(const toml::node& node) {
    const auto* inside = node.as_table();
    if (inside == nullptr) return false;
    (void)read_provenance(TableReader(*inside, file_, errors_));
    return true;
  }

  /// A list of tables, `[[name]]`; replaces the parent's.
  template <class T>
  Handler tables(std::vector<T>& out, Result<void> (*parse)(const TableReader&, T&)) {
    const auto read = [this, &out, parse](const toml::node& node) {
      const auto* array = node.as_array();
      if (array == nullptr) return false;
      out.clear();
      for (const auto& element : *array) {
        const auto* inside = element.as_table();
        if (inside == nullptr) return false;
        (void)parse(TableReader(*inside, file_, errors_), out.emplace_back());
      }
      return true;
    };
    return {read, "it as a list of sections: [[NAME]]"};
  }

  /// A string is Chinese, as the manuals are; a table says both.
  bool abort_text(const toml::node& node, AbortText& out) {
    if (get(node, out.text_zh)) return true;
    const auto* both = node.as_table();
    if (both != nullptr)
      (void)TableReader(*both, file_, errors_)
          .read({{"text", into(out.text)}, {"text_zh", into(out.text_zh)}});
    return both != nullptr;
  }

  bool contradicted(const toml::node& node) {
    std::vector<std::string> parts;
    if (!get(node, parts)) return false;
    rules_.contradicted.clear();
    for (const auto& part : parts) {
      auto marks = od::parse_marks(part);
      if (!marks || marks->size() != 1 || marks->front().lines.empty()) return false;
      rules_.contradicted.push_back(std::move(marks->front()));
    }
    return true;
  }

  bool abort_codes(const toml::node& node) {
    const auto* inside = node.as_table();
    if (inside == nullptr) return false;
    for (const auto& [key, value] : *inside) {
      const auto code = parse_integer(std::string_view(key.str()));
      AbortText words;
      if (!code || code->negative || code->magnitude > 0xFFFF'FFFFU || !abort_text(value, words))
        return false;
      rules_.abort_texts[static_cast<std::uint32_t>(code->magnitude)] = std::move(words);
    }
    return true;
  }

  std::string_view file_;
  Rules rules_;
  std::vector<Error>* errors_;
};

}  // namespace

std::string_view name(NmtRules::Restart restart) {
  switch (restart) {
    case NmtRules::Restart::reset_node: return "reset node";
    case NmtRules::Restart::reset_communication: return "reset communication";
    case NmtRules::Restart::power_cycle: break;
  }
  return "power cycle";
}

std::optional<std::uint32_t> Numbering::number(std::string_view id) const {
  if (id.size() <= prefix.size() || !equals_nocase(id.substr(0, prefix.size()), prefix)) return std::nullopt;
  const auto digits = id.substr(prefix.size());
  const auto point = digits.find('.');
  if ((group != 0) != (point != std::string_view::npos)) return std::nullopt;
  const auto last = parse_digits(group != 0 ? digits.substr(point + 1) : digits, base);
  const auto first = group != 0 ? parse_digits(digits.substr(0, point), base) : 0;
  if (!last || !first || *last > 0xFFFF || *first > 0xFF || (group != 0 && *last >= group))
    return std::nullopt;
  return static_cast<std::uint32_t>(*first * group + *last);
}

ObjectAddress Numbering::object(std::uint32_t number) const {
  return {static_cast<std::uint16_t>(index + number / block),
          static_cast<std::uint8_t>(number % block + first_sub)};
}

bool Rules::is_assumed(std::string_view key) const {
  return std::find(assumed.begin(), assumed.end(), key) != assumed.end();
}

bool MotionRules::is_actuated(std::uint32_t inputs_word, unsigned bit) const {
  const bool high = (inputs_word >> bit & 1U) != 0;
  return high ==
         (std::find(inputs_active_low.begin(), inputs_active_low.end(), bit) == inputs_active_low.end());
}

Rules read_rules(std::string_view toml, std::string_view file, Rules base, std::vector<Error>& errors) {
  if (const auto flat = check_toml_depth(toml, file); !flat) {
    errors.push_back(flat.error());
    return base;
  }
  const auto parsed = toml::parse(toml, file);
  if (parsed) return RulesReader(file, std::move(base), errors).read(parsed.table());
  const auto at = parsed.error().source().begin;
  errors.push_back(file_error(file, at.line, at.column, parsed.error().description()));
  return base;
}

Result<Rules> parse_rules(std::string_view toml, std::string_view file, Rules base) {
  std::vector<Error> errors;
  auto out = read_rules(toml, file, std::move(base), errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return out;
}

std::string parent_of(std::string_view toml) {
  if (toml.find("parent") == std::string_view::npos) return {};
  if (!check_toml_depth(toml, {})) return {};
  const auto parsed = toml::parse(toml);
  if (!parsed) return {};
  return parsed.table()["parent"].value_or(std::string());
}

}  // namespace servoctl::drive
