#include "cabinet/cabinet.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"

namespace servoctl::cabinet {
namespace {

template <class T>
const T* named(const std::vector<T>& all, std::string_view name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const T& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

bool is_in(const Axis& axis, std::string_view group) {
  return std::find(axis.groups.begin(), axis.groups.end(), group) != axis.groups.end();
}

}  // namespace

const Bus* Cabinet::bus(std::string_view name) const { return named(buses, name); }
const Axis* Cabinet::axis(std::string_view name) const { return named(axes, name); }

const Axis* Cabinet::at(std::string_view bus, std::uint8_t node) const {
  const auto found = std::find_if(axes.begin(), axes.end(),
                                  [&](const Axis& axis) { return axis.node == node && axis.bus == bus; });
  return found == axes.end() ? nullptr : &*found;
}

std::vector<std::string> Cabinet::names() const {
  std::vector<std::string> out;
  for (const auto& axis : axes) out.push_back(axis.name);
  std::set<std::string> groups;
  for (const auto& axis : axes) groups.insert(axis.groups.begin(), axis.groups.end());
  out.insert(out.end(), groups.begin(), groups.end());
  return out;
}

bool Cabinet::knows(std::string_view name) const {
  return axis(name) != nullptr ||
         std::any_of(axes.begin(), axes.end(), [&](const Axis& one) { return is_in(one, name); });
}

Result<std::vector<const Axis*>> Cabinet::select(std::string_view list) const {
  std::set<const Axis*> chosen;
  for (const auto part : split(list, ',')) {
    const auto word = trim(part);
    if (word.empty()) continue;
    const bool all = equals_nocase(word, "all");
    if (!all && !knows(word)) {
      const auto all_names = names();
      const auto nearest = did_you_mean(word, all_names);
      return fail(Errc::usage,
                  message("{} has no axis '{}'", as_it_is(file.filename().string()), as_it_is(word)),
                  nearest.empty() ? "its axes: " + one_of(all_names) : nearest);
    }
    for (const auto& one : axes)
      if (all || one.name == word || is_in(one, word)) chosen.insert(&one);
  }
  std::vector<const Axis*> out;
  for (const auto& one : axes)
    if (chosen.count(&one) != 0) out.push_back(&one);
  if (out.empty())
    return fail(Errc::usage, message("'{}' names no axis", as_it_is(list)), "its axes: " + one_of(names()));
  return out;
}

std::filesystem::path find_cabinet(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (auto at = folder; !at.empty(); at = at.parent_path()) {
    const auto file = at / "cabinet.toml";
    if (std::filesystem::is_regular_file(file, ignored)) return file;
    if (at == at.parent_path()) break;
  }
  return {};
}

Error cabinet_error(const Cabinet& cabinet, const Axis& axis, Place at, const Message& what, Message hint) {
  auto error = file_error(cabinet.file.string(), at.line, at.column,
                          message("axis {}: {}", as_it_is(axis.name), what));
  error.hint = std::move(hint);
  return error;
}

}  // namespace servoctl::cabinet
