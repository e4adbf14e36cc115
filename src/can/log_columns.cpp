#include "can/log_columns.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "base/text.hpp"
#include "can/log_column_names.hpp"

namespace servoctl::can {
namespace {

LogColumns columns_of(const std::vector<std::string_view>& cells, char separator, std::size_t& known) {
  LogColumns out;
  out.separator = separator;
  known = 0;
  bool intrepid = false;
  bool python = false;
  std::optional<std::pair<std::size_t, HeaderName>> delta;
  for (const auto cell : cells) {
    const auto name = header_name(cell);
    if (!delta && is_delta_name(name.name)) delta.emplace(out.roles.size(), name);
    const auto found = role_of_name(name.name);
    auto role = found.value_or(LogRole::skip);
    known += found.has_value();
    // The first of several times, channels and kinds is the one to be read.
    const bool once = role != LogRole::byte && role != LogRole::words;
    if (once && out.has(role)) role = LogRole::skip;
    if (role != LogRole::skip) take_qualifier(role, name, out.numbers);
    intrepid = intrepid || name.name == "arbid";
    python = python || name.name == "arbitrationid";
    if (role == LogRole::byte) out.bytes.push_back(static_cast<std::size_t>(name.name.back() - '0'));
    out.roles.push_back(role);
  }
  if (delta && !out.has(LogRole::time)) {
    out.roles[delta->first] = LogRole::time;
    take_qualifier(LogRole::time, delta->second, out.numbers);
    out.numbers.relative = true;
    ++known;
  }
  // The tables of Intrepid have them in hexadecimal, and those of GVRET microseconds.
  if (intrepid) out.numbers.id_base = out.numbers.data_base = 16;
  const bool gvret = out.has(LogRole::extended) && out.has(LogRole::channel) && out.has(LogRole::length) &&
                     out.has(LogRole::byte);
  if (gvret && out.numbers.unit == TimeUnit::open) out.numbers.unit = TimeUnit::microseconds;
  // The tables of python-can have every flag in a column, and the data in base64.
  out.numbers.base64 =
      python && out.has(LogRole::extended) && out.has(LogRole::remote) && out.has(LogRole::error);
  return out;
}

/// The separator by which a line names the most columns, and these.
LogColumns best_columns(std::string_view line, std::size_t& known) {
  LogColumns best;
  known = 0;
  std::vector<std::string_view> cells;
  for (const char separator : {',', ';', '\t', ' '}) {
    split_cells(line, separator, cells);
    std::size_t count = 0;
    auto columns = columns_of(cells, separator, count);
    if (count <= known) continue;
    best = std::move(columns);
    known = count;
  }
  return best;
}

/// Their numbers counted from 0: `D7` to `D0` count down. False where one is missing or twice there.
bool count_bytes(std::vector<std::size_t>& bytes) {
  if (bytes.empty()) return true;
  const auto first = *std::min_element(bytes.begin(), bytes.end());
  std::set<std::size_t> seen;
  for (auto& byte : bytes) seen.insert(byte -= first);
  return seen.size() == bytes.size() && *seen.rbegin() + 1 == bytes.size();
}

void put_byte(std::size_t at, std::string_view cell, std::vector<std::string_view>& out) {
  if (out.size() <= at) out.resize(at + 1);
  out[at] = cell;
}

}  // namespace

bool LogColumns::has(LogRole role) const {
  return role != LogRole::skip && std::find(roles.begin(), roles.end(), role) != roles.end();
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& out) {
  out.clear();
  constexpr std::string_view kBlank = " \t";
  if (separator == ' ') {
    for (line = trim(line); !line.empty(); line = trim(line)) {
      const auto end = std::min(line.find_first_of(kBlank), line.size());
      out.push_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    return;
  }
  for (bool more = true; more;) {
    std::size_t end = 0;
    for (bool quoted = false; end < line.size() && (quoted || line[end] != separator); ++end)
      if (line[end] == '"') quoted = !quoted;
    out.push_back(line.substr(0, end));
    more = end < line.size();
    line.remove_prefix(std::min(end + 1, line.size()));
  }
}

bool names_columns(std::string_view line) {
  constexpr std::size_t kFew = 3;
  std::size_t known = 0;
  (void)best_columns(line, known);
  return known >= kFew;
}

std::optional<LogColumns> read_column_names(std::string_view line) {
  std::size_t known = 0;
  auto out = best_columns(line, known);
  // Names between blanks are of columns that may be empty: which cell is which, they do not tell.
  const bool data = out.has(LogRole::data) || out.has(LogRole::byte);
  if (out.separator == ' ' || !out.has(LogRole::id) || !data || !count_bytes(out.bytes)) return std::nullopt;
  return out;
}

bool place_cells(const LogColumns& columns, const std::vector<std::string_view>& cells, LogCells& out) {
  constexpr std::size_t kOneByte = 4;  // `0x40`.
  out.clear();
  std::size_t byte = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    // Bytes in cells of their own behind one heading.
    const bool beyond = i >= columns.roles.size() && !out.data.empty() &&
                        bare_value(out.data.front()).size() <= kOneByte &&
                        (columns.roles.back() == LogRole::data || columns.roles.back() == LogRole::byte);
    switch (i < columns.roles.size() ? columns.roles[i] : beyond ? columns.roles.back() : LogRole::skip) {
      case LogRole::time: out.time = cells[i]; break;
      case LogRole::date: out.date = cells[i]; break;
      case LogRole::id: out.id = cells[i]; break;
      case LogRole::decimal_id: out.decimal_id = cells[i]; break;
      case LogRole::length: out.length = cells[i]; break;
      case LogRole::byte:
        out.data_by_byte = true;
        put_byte(byte < columns.bytes.size() ? columns.bytes[byte] : byte, cells[i], out.data);
        ++byte;
        break;
      case LogRole::data: out.data.push_back(cells[i]); break;
      case LogRole::words:
        out.words.unknown |= !read_log_words(cells[i], out.words) && !bare_value(cells[i]).empty();
        break;
      case LogRole::channel: out.channel = cells[i]; break;
      case LogRole::extended: out.extended = cells[i]; break;
      case LogRole::remote: out.remote = cells[i]; break;
      case LogRole::error: out.error = cells[i]; break;
      case LogRole::fd: out.fd = cells[i]; break;
      case LogRole::skip: break;
    }
  }
  return !bare_value(out.id).empty() || out.words.error || is_yes(out.error);
}

}  // namespace servoctl::can
