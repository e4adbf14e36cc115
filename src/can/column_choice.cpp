#include "can/column_choice.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/log_fields.hpp"

namespace servoctl::can {
namespace {

struct ChoiceName {
  std::string_view name;
  LogRole role;
};
constexpr ChoiceName kChoices[] = {
    {"time", LogRole::time},  {"date", LogRole::date},       {"id", LogRole::id},
    {"len", LogRole::length}, {"data", LogRole::data},       {"byte", LogRole::byte},
    {"type", LogRole::words}, {"channel", LogRole::channel}, {"ext", LogRole::extended},
    {"rtr", LogRole::remote}, {"error", LogRole::error},     {"-", LogRole::skip},
};

/// `dec`, `ms` … behind the colon; false where it says nothing of such a column.
bool take_choice(LogRole role, std::string_view how, LogNumbers& out) {
  const unsigned base = how == "hex" ? 16 : how == "dec" ? 10 : 0;
  if (role == LogRole::id && base != 0) return (out.id_base = base, true);
  if ((role == LogRole::data || role == LogRole::byte) && base != 0) return (out.data_base = base, true);
  if (role != LogRole::time) return false;
  if (how == "delta") return (out.relative = true);
  out.unit = how == "s"    ? TimeUnit::seconds
             : how == "ms" ? TimeUnit::milliseconds
             : how == "us" ? TimeUnit::microseconds
                           : TimeUnit::open;
  return out.unit != TimeUnit::open;
}

}  // namespace

Result<ColumnChoice> ColumnChoice::parse(std::string_view text) {
  ColumnChoice out;
  const auto refused = [&](Message what) {
    return fail(
        Errc::usage, std::move(what),
        "write the columns in their order, `time:ms,-,id:dec,len,data`, or with their headings, `id=CAN ID,data=Payload`; "
        "each is one of `time date id len data byte type channel ext rtr error -`");
  };
  std::size_t named = 0;
  for (const auto part : split(text, ',')) {
    const auto equals = std::min(part.find('='), part.size());
    auto name = trim(part.substr(0, equals));
    const auto colon = std::min(name.find(':'), name.size());
    const auto how = name.substr(std::min(colon + 1, name.size()));
    name = name.substr(0, colon);
    const auto* found = std::find_if(std::begin(kChoices), std::end(kChoices),
                                     [&](const auto& each) { return equals_nocase(each.name, name); });
    if (found == std::end(kChoices)) return refused(message("'{}' is no column", as_it_is(name)));
    if (!how.empty() && !take_choice(found->role, how, out.columns_.numbers))
      return refused(message("'{}' is no way to write the column {}", as_it_is(how), as_it_is(name)));
    out.columns_.roles.push_back(found->role);
    named += equals < part.size();
    out.names_.emplace_back(trim(part.substr(std::min(equals + 1, part.size()))));
  }
  if (named > 0 && named < out.names_.size())
    return refused("some of the columns have a name, and some have none");
  if (named == 0) out.names_.clear();
  if (!out.columns_.has(LogRole::id)) return refused("--columns names no identifier");
  if (!out.columns_.has(LogRole::data) && !out.columns_.has(LogRole::byte))
    return refused("--columns names no data");
  return out;
}

std::optional<LogColumns> ColumnChoice::by_header(std::string_view line) const {
  std::vector<std::string_view> cells;
  for (const char separator : {',', ';', '\t'}) {
    split_cells(line, separator, cells);
    auto out = columns_;
    out.separator = separator;
    out.roles.assign(cells.size(), LogRole::skip);
    std::size_t found = 0;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto at = std::find_if(cells.begin(), cells.end(),
                                   [&](auto cell) { return equals_nocase(bare_value(cell), names_[i]); });
      if (at == cells.end()) break;
      out.roles[static_cast<std::size_t>(at - cells.begin())] = columns_.roles[i];
      ++found;
    }
    if (found == names_.size()) return out;
  }
  return std::nullopt;
}

LogColumns ColumnChoice::in_order(char separator) const {
  auto out = columns_;
  out.separator = separator;
  return out;
}

}  // namespace servoctl::can
