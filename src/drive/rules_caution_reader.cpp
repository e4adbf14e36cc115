#include <array>
#include <string_view>
#include <utility>

#include "drive/rules_reader.hpp"

namespace servoctl::drive {
namespace {

constexpr std::array kInputs{std::pair{std::string_view("negative limit"), Input::negative_limit},
                             std::pair{std::string_view("positive limit"), Input::positive_limit},
                             std::pair{std::string_view("home switch"), Input::home}};
constexpr std::array kUses{
    std::pair{std::string_view("enable"), Use::enable}, std::pair{std::string_view("jog"), Use::jog},
    std::pair{std::string_view("move"), Use::move}, std::pair{std::string_view("home"), Use::home},
    std::pair{std::string_view("torque"), Use::torque}};

/// A list of words of this table.
template <class T, class Words>
TableReader::Handler words_into(std::vector<T>& out, const Words& words) {
  return [&out, &words](const toml::node& node) {
    return get_list(node, out, [&](const toml::node& one, T& place) {
      std::string text;
      if (!get(one, text)) return false;
      for (const auto& [word, value] : words)
        if (word == text) {
          place = value;
          return true;
        }
      return false;
    });
  };
}

}  // namespace

Result<void> read_caution(const TableReader& reader, Caution& out) {
  return reader.read({{"name", into(out.name)},
                      {"value", into(out.value)},
                      {"not", into(out.not_value)},
                      {"others", into(out.others)},
                      {"set", into(out.set)},
                      {"text", into(out.text)},
                      {"text_zh", into(out.text_zh)},
                      {"concerns", words_into(out.concerns, kUses)},
                      {"masks", words_into(out.masks, kInputs)},
                      {"blocks", words_into(out.blocks, kUses)},
                      {"methods", into(out.methods)},
                      {"speed", into(out.speed)},
                      {"torque", into(out.torque)}});
}

}  // namespace servoctl::drive
