#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/duration.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cabinet/axis_part.hpp"
#include "cabinet/cabinet.hpp"
#include "cabinet/name_pattern.hpp"
#include "canopen/node_list.hpp"
#include "drive/bitrate.hpp"
#include "drive/naming.hpp"
#include "drive/toml_depth.hpp"
#include "drive/toml_reader.hpp"
#include "session/bitrate_search.hpp"
#include "session/open_bus.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::cabinet {
namespace {

using drive::get;
using drive::get_int;
using drive::TableReader;

constexpr std::uintmax_t kMostBytes = 4U << 20U;
constexpr std::string_view kBitrateForm =
    "bitrate = \"500k\" (10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k or 1M)";

/// Tables by name, `[axis.NAME]`, in the order of the file: toml++ sorts them by name.
Result<std::vector<std::pair<std::string, const toml::table*>>> named_tables(const TableReader& root,
                                                                             std::string_view kind,
                                                                             const toml::node& node) {
  std::vector<std::pair<std::string, const toml::table*>> out;
  const auto* all = node.as_table();
  if (all == nullptr)
    return root.fail_at(node, message("'{0}' is a table of tables: [{0}.NAME]", as_it_is(kind)));
  for (const auto& [key, one] : *all) {
    const auto* table = one.as_table();
    if (table == nullptr)
      return root.fail_at(one,
                          message("'{0}' is no table: write [{1}.{0}]", as_it_is(key.str()), as_it_is(kind)));
    out.emplace_back(std::string(key.str()), table);
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return a.second->source().begin < b.second->source().begin;
  });
  return out;
}

class CabinetReader {
 public:
  explicit CabinetReader(const std::filesystem::path& file) : name_(file.string()) { out_.file = file; }

  Result<Cabinet> read(const toml::table& table) {
    std::int64_t format = 1;
    const TableReader root(table, name_);
    const auto known = root.read({{"format", [&](const auto& n) { return get_int(n, format); }},
                                  {"bus", [](const auto&) { return true; }},
                                  {"family", [](const auto&) { return true; }},
                                  {"group", [](const auto&) { return true; }},
                                  {"axis", [](const auto&) { return true; }}});
    if (!known) return fail(known.error());
    if (format != 1) return root.fail_at(*table.get("format"), "this program reads format = 1");
    for (const auto step : {&CabinetReader::buses, &CabinetReader::defaults, &CabinetReader::axes})
      if (const auto done = (this->*step)(root, table); !done) return fail(done.error());
    if (out_.axes.empty())
      return fail(Errc::file, message("{} has no axis", as_it_is(name_)),
                  "write [axis.NAME] with node and family");
    return std::move(out_);
  }

 private:
  Result<void> buses(const TableReader& root, const toml::table& table) {
    const auto* node = table.get("bus");
    if (node == nullptr)
      return fail(Errc::file, message("{} has no bus", as_it_is(name_)),
                  "write [bus.main] with url = \"can0\"");
    const auto all = named_tables(root, "bus", *node);
    if (!all) return fail(all.error());
    for (const auto& [name, one] : *all) {
      Bus bus;
      bus.name = name;
      bus.at = {one->source().begin.line, one->source().begin.column};
      const TableReader reader(*one, name_);
      const auto done =
          reader.read({{"url", drive::into(bus.url)},
                       {"bitrate", [&](const auto& n) { return read_bitrate(n, bus.bitrate); }}},
                      {{"url", "url = \"can0\""}, {"bitrate", kBitrateForm}});
      if (!done) return done;
      if (bus.url.empty()) return reader.fail_at(*one, message("bus {}: 'url' is missing", as_it_is(name)));
      if (const auto good = session::check_url(bus.url); !good)
        return fail_at(*one->get("url"), message("bus {}: {}", as_it_is(name), good.error().message),
                       good.error().hint);
      if (session::is_modbus(bus.url))
        return fail_at(
            *one->get("url"),
            message("bus {}: drives on Modbus cannot stand in a cabinet file", as_it_is(name)),
            "name the line with -b and the drive with -d and -n; `backup` and `restore` work there");
      for (const auto& other : out_.buses)
        if (other.url == bus.url)
          return fail_at(*one,
                         message("bus {} is {}, and so is bus {}", as_it_is(name), as_it_is(bus.url),
                                 as_it_is(other.name)),
                         "one interface is one bus: put its axes on one of them");
      out_.buses.push_back(std::move(bus));
    }
    return {};
  }

  static bool read_bitrate(const toml::node& node, std::string& out) {
    const auto bitrate = get(node, out) ? drive::parse_bitrate(out) : Result<std::uint32_t>();
    const auto usual = session::usual_bitrates();
    return bitrate && std::count(usual.begin(), usual.end(), *bitrate) > 0;
  }

  Result<void> defaults(const TableReader& root, const toml::table& table) {
    for (const auto& [key, place] : {std::pair("family", &families_), std::pair("group", &groups_)}) {
      const auto* node = table.get(key);
      if (node == nullptr) continue;
      const auto all = named_tables(root, key, *node);
      if (!all) return fail(all.error());
      for (const auto& [name, one] : *all) {
        auto part =
            read_part(*one, name_, std::string_view(key) == "family" ? PartOf::family : PartOf::group);
        if (!part) return fail(part.error());
        if (place == &groups_)
          if (const auto good = check_name(name, "a group", *one); !good) return good;
        place->emplace(name, std::move(*part));
      }
    }
    return {};
  }

  Result<void> axes(const TableReader& root, const toml::table& table) {
    const auto* node = table.get("axis");
    const auto all = node == nullptr ? Result<std::vector<std::pair<std::string, const toml::table*>>>()
                                     : named_tables(root, "axis", *node);
    if (!all) return fail(all.error());
    for (const auto& [name, one] : *all) {
      auto part = read_part(*one, name_, PartOf::axis);
      if (!part) return fail(part.error());
      if (const auto added = add_axes(name, *one, *part); !added) return added;
    }
    return check_places();
  }

  /// One axis, or as many as the name's `{1-40}` says.
  Result<void> add_axes(const std::string& pattern, const toml::table& table, const AxisPart& part) {
    const auto names = expand_name(pattern);
    if (!names) return fail_at(table, names.error().message);
    if (part.nodes.empty()) return fail_at(table, message("axis {}: 'node' is missing", as_it_is(pattern)));
    if (names->size() != part.nodes.size())
      return fail_at(table, message("axis {}: {} name{} for {} node{}", as_it_is(pattern), names->size(),
                                    plural(names->size()), part.nodes.size(), plural(part.nodes.size())));
    if (names->size() > 1 && part.serial)
      return fail_at(table, message("axis {}: each drive has a serial number of its own", as_it_is(pattern)));
    for (std::size_t i = 0; i < names->size(); ++i) {
      if (const auto good = check_name((*names)[i], "an axis", table); !good) return good;
      auto axis = make_axis((*names)[i], table, part);
      if (!axis) return fail(axis.error());
      axis->node = part.nodes[i];
      out_.axes.push_back(std::move(*axis));
    }
    return {};
  }

  Result<Axis> make_axis(const std::string& name, const toml::table& table, AxisPart part) const {
    Axis out;
    out.name = name;
    out.at = {table.source().begin.line, table.source().begin.column};
    for (auto group = part.groups.rbegin(); group != part.groups.rend(); ++group) {
      const auto found = groups_.find(*group);
      if (found != groups_.end()) {
        fill_from(part, found->second);
        continue;
      }
      std::vector<std::string> known;
      for (const auto& one : groups_) known.push_back(one.first);
      return fail_at(table, message("axis {}: there is no [group.{}]", as_it_is(name), as_it_is(*group)),
                     did_you_mean(*group, known));
    }
    if (part.family.empty())
      return fail_at(table, message("axis {}: 'family' is missing: gsd600, or a file", as_it_is(name)));
    if (const auto found = families_.find(part.family); found != families_.end())
      fill_from(part, found->second);
    out.family = file_or_family(part.family);
    if (part.bus.empty() && out_.buses.size() == 1) part.bus = out_.buses.front().name;
    if (part.bus.empty())
      return fail_at(table,
                     message("axis {}: 'bus' is missing: there are {}", as_it_is(name), out_.buses.size()),
                     message("bus = \"{}\", or that of another", as_it_is(out_.buses.front().name)));
    if (out_.bus(part.bus) == nullptr) {
      std::vector<std::string> known;
      for (const auto& bus : out_.buses) known.push_back(bus.name);
      return fail_at(table, message("axis {}: there is no [bus.{}]", as_it_is(name), as_it_is(part.bus)),
                     did_you_mean(part.bus, known));
    }
    out.bus = part.bus;
    if (const auto load = set_load(part, out); !load) return fail(load.error());
    take_over(std::move(part), out);
    return out;
  }

  /// A file is named from where the cabinet file stands.
  std::string file_or_family(const std::string& text) const {
    const bool file = text.find('/') != std::string::npos || text.find('.') != std::string::npos;
    if (!file || text.front() == '/') return text;
    return (out_.file.parent_path() / text).string();
  }

  Result<void> set_load(const AxisPart& part, Axis& out) const {
    if (!part.per_turn) return {};
    auto load = drive::parse_load_unit(*part.per_turn, part.gear.value_or(1));
    if (load) {
      out.load = std::move(*load);
      return {};
    }
    auto error = file_error(name_, part.per_turn_at.line, part.per_turn_at.column,
                            message("per_turn: {}", load.error().message));
    error.hint = load.error().hint;
    return fail(std::move(error));
  }

  void take_over(AxisPart part, Axis& out) const {
    out.groups = std::move(part.groups);
    out.serial = part.serial;
    out.turn = part.turn;
    out.encoder = part.encoder;
    out.limits = std::move(part.limits);
    out.heartbeat = part.heartbeat;
    out.heartbeat_at = part.heartbeat_at;
    out.pdos = std::move(part.pdos);
    if (!out.pdos.file.empty() && out.pdos.file.is_relative())
      out.pdos.file = out_.file.parent_path() / out.pdos.file;
    out.parameters = std::move(part.parameters);
  }

  Result<void> check_name(const std::string& name, std::string_view what, const toml::table& table) {
    if (!is_name(name))
      return fail_at(table, message("'{}' cannot be the name of {}", as_it_is(name), what),
                     "a letter first; no space, comma, dot or quote; not `all`");
    if (!names_.insert(name).second)
      return fail_at(table, message("'{}' is the name of two things", as_it_is(name)),
                     "axes and groups share their names: -n takes both");
    return {};
  }

  Result<void> check_places() const {
    for (std::size_t i = 0; i < out_.axes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (out_.axes[i].bus == out_.axes[j].bus && out_.axes[i].node == out_.axes[j].node)
          return fail(cabinet_error(out_, out_.axes[i], out_.axes[i].at,
                                    message("node {} on bus {} is axis {} already", out_.axes[i].node,
                                            as_it_is(out_.axes[i].bus), as_it_is(out_.axes[j].name))));
    return {};
  }

  tl::unexpected<Error> fail_at(const toml::node& node, const Message& what, Message hint = {}) const {
    const auto at = node.source().begin;
    auto error = file_error(name_, at.line, at.column, what);
    error.hint = std::move(hint);
    return fail(std::move(error));
  }

  std::string name_;
  Cabinet out_;
  std::map<std::string, AxisPart> families_;
  std::map<std::string, AxisPart> groups_;
  std::set<std::string> names_;
};

}  // namespace

Result<Cabinet> parse_cabinet(std::string_view toml, const std::filesystem::path& file) {
  const auto name = file.string();
  if (const auto flat = drive::check_toml_depth(toml, name); !flat) return fail(flat.error());
  const auto parsed = toml::parse(toml, name);
  if (parsed) return CabinetReader(file).read(parsed.table());
  const auto at = parsed.error().source().begin;
  auto error = file_error(name, at.line, at.column, parsed.error().description());
  error.hint =
      parsed.error().description().find("redefine") != std::string_view::npos
          ? "each key, and each name in brackets, stands once"
          : "one key = value a line, and what is no number in quotes, keys with other letters than A to "
            "Z too: family = \"gsd600\"";
  return fail(std::move(error));
}

Result<Cabinet> read_cabinet(const std::filesystem::path& file) {
  const auto text = read_file(file, kMostBytes);
  if (!text) return fail(text.error());
  return parse_cabinet(*text, file);
}

}  // namespace servoctl::cabinet
