// What tells the topics of a file apart, for Tab: to read all that they say takes ten times as long.
#include <algorithm>
#include <array>

#include "drive/toml_depth.hpp"
#include "drive/toml_reader.hpp"
#include "drive/topics.hpp"

namespace servoctl::drive {
namespace {

bool has_key(std::string_view line, std::string_view key) {
  return line.starts_with(key) && trim(line.substr(key.size())).starts_with('=');
}

/// The headings of tables, and the lines that hold the keys of a head, where each stands at the beginning of
/// a line of its own.
std::string lines_of_heads(std::string_view toml) {
  constexpr std::array<std::string_view, 6> kKeys{"kind", "name", "object", "value", "network", "mode"};
  constexpr std::string_view kFirstLetters = "[kmnovp";  // Of most lines they settle it.
  std::string out;
  for (const auto line : split(toml, '\n')) {
    if (line.empty() || kFirstLetters.find(line.front()) == std::string_view::npos) continue;
    const auto is_of = [&](std::string_view key) { return has_key(line, key); };
    if (line.starts_with('[') || std::any_of(kKeys.begin(), kKeys.end(), is_of)) (out += line) += '\n';
    if (is_of("picture")) out += "picture=true\n";
  }
  return out;
}

std::optional<Topic> head_in(const toml::node& node, std::string_view family) {
  const auto* table = node.as_table();
  if (table == nullptr) return std::nullopt;
  Topic out;
  out.family = family;
  const auto take = [&](std::string_view key, auto& place) {
    const auto* value = table->get(key);
    return value == nullptr || drive::get(*value, place);
  };
  bool picture = false;
  const bool right = take("kind", out.kind) && take("name", out.name) && take("object", out.object) &&
                     take("value", out.value) && take("network", out.network) && take("mode", out.mode) &&
                     take("picture", picture);
  if (!right || out.kind.empty() || out.name.empty()) return std::nullopt;
  if (picture) out.picture = "-";
  return out;
}

/// Empty where the file is written in another form than ours.
std::optional<std::vector<Topic>> heads_in(std::string_view toml, std::string_view family) {
  const auto lines = lines_of_heads(toml);
  if (!check_toml_depth(lines, {})) return std::nullopt;
  const auto parsed = toml::parse(lines);
  const auto* topics = parsed ? parsed.table().get_as<toml::array>("topic") : nullptr;
  if (topics == nullptr) return std::nullopt;
  std::vector<Topic> out;
  for (const auto& element : *topics) {
    auto head = head_in(element, family);
    if (!head) return std::nullopt;
    out.push_back(std::move(*head));
  }
  return out;
}

}  // namespace

Result<std::vector<Topic>> parse_topic_heads(std::string_view toml, std::string_view file,
                                             std::string_view family) {
  if (auto heads = heads_in(toml, family)) return std::move(*heads);
  return parse_topics(toml, file, family);
}

}  // namespace servoctl::drive
