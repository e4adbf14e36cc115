#include "drive/parameter_ids.hpp"

#include <unordered_map>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/name_key.hpp"
#include "drive/naming.hpp"

namespace servoctl::drive {
namespace {

/// The first object of each name that a command may call it by.
std::unordered_map<std::string, ObjectAddress> named_objects(const od::Dictionary& dictionary) {
  std::unordered_map<std::string, ObjectAddress> out;
  for (const auto& object : dictionary.objects())
    for (const auto& entry : object.entries) {
      out.emplace(name_key(object.name), entry.address);
      out.emplace(entry_name(object, entry), entry.address);
    }
  return out;
}

std::string shadowed_by(const od::Parameter& parameter,
                        const std::unordered_map<std::string, ObjectAddress>& names) {
  const auto& id = parameter.id;
  if (id.starts_with('-')) return formatted("number '{}' begins as an option does", id);
  if (equals_nocase(id, "all")) return formatted("number '{}' is the word for all parameters", id);
  if (const auto address = parse_object_address(id); address && address != parameter.object)
    return formatted("number '{}' is the address of object {}", id, to_string(*address));
  const auto named = names.find(name_key(id));
  if (named == names.end() || named->second == parameter.object) return {};
  return formatted("number '{}' is the name of object {}", id, to_string(named->second));
}

}  // namespace

std::string canonical_id(std::string_view id) {
  std::string out;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_alnum = [&](char c) { return is_digit(c) || (c >= 'a' && c <= 'z'); };
  const auto text = lower(id);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '_' || c == '-') {
      // Between two digits the separator says where one number ends: P3-5 is not P35.
      if (!out.empty() && is_digit(out.back()) && i + 1 < text.size() && is_digit(text[i + 1])) out += '.';
      continue;
    }
    const bool leading = out.empty() || !is_digit(out.back());
    if (c == '0' && leading && i + 1 < text.size() && is_alnum(text[i + 1])) continue;
    out += c;
  }
  return out;
}

void refuse_same_ids(std::span<const od::Parameter> parameters, std::string_view file,
                     std::vector<Error>& errors) {
  std::unordered_map<std::string, const od::Parameter*> known;
  for (const auto& parameter : parameters) {
    const auto [first, is_new] = known.emplace(canonical_id(parameter.id), &parameter);
    if (is_new) continue;
    errors.push_back(
        file_error(file, parameter.file_line,
                   message("{} is the same parameter number as {} in line {}", parameter.id,
                           first->second->id, first->second->file_line),
                   "case, _, - and leading zeros do not tell numbers apart: give each a number of its own"));
  }
}

std::vector<Error> shadowing_ids(std::span<const od::Parameter> parameters, const od::Dictionary& dictionary,
                                 std::string_view file) {
  const auto names = named_objects(dictionary);
  std::vector<Error> out;
  for (const auto& parameter : parameters)
    if (const auto shadow = shadowed_by(parameter, names); !shadow.empty())
      out.push_back(file_error(file, parameter.file_line, shadow,
                               message("give the parameter another number, such as P-{}", parameter.id)));
  return out;
}

}  // namespace servoctl::drive
