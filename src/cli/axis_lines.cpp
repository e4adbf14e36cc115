#include "cli/axis_lines.hpp"

#include <algorithm>
#include <cctype>

#include "base/format.hpp"
#include "base/found_file.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cli/bus_choice.hpp"

namespace servoctl::cli {
namespace {

using cabinet::Axis;
using cabinet::Cabinet;
using command::Needs;

std::string numbers_of(const std::vector<const Axis*>& axes) {
  std::string out;
  for (const auto* axis : axes) append(out, std::to_string(axis->node), ",");
  return out;
}

/// Of all axes of the bus: notices speak of those too that the line does not name.
show::AxisNames names_on(const Cabinet& cabinet, std::string_view bus) {
  std::map<std::uint8_t, std::string> out;
  for (const auto& axis : cabinet.axes)
    if (axis.bus == bus) out.emplace(axis.node, axis.name);
  return show::AxisNames(std::move(out));
}

/// With other counts than those of its drive a motor turns at another speed than was asked for.
Result<void> check_counts(const Cabinet& cabinet, const Axis& axis, const command::Arguments& arguments,
                          std::string_view key, std::optional<std::uint64_t> in_file) {
  const auto option = "--" + std::string(key);
  const auto typed = parse_integer(arguments.text(option));
  if (!in_file || !typed || (typed->magnitude == *in_file && !typed->negative)) return {};
  return fail(Errc::usage,
              message("{} has {} = {} by {}, not {}", as_it_is(axis.name), as_it_is(key), as_it_is(*in_file),
                      as_it_is(cabinet.file.filename().string()), as_it_is(arguments.text(option))),
              message("leave {} out, or change the file", as_it_is(option)));
}

/// How to get rid of a setting that contradicts the file.
std::string without(Source source, std::string_view option) {
  switch (source) {
    case Source::environment: return formatted("unset {}", name_of(source, option));
    case Source::set: return "choose another one at the prompt";
    default: return formatted("leave {} out", option);
  }
}

/// A line, and where it names the axes that it is for.
struct Named {
  const Cabinet* cabinet;
  const command::Arguments* arguments;
  const Settings* settings;
  Source from;
  std::vector<Message>* notices;
  bool way_out = false;  ///< Nothing that is set keeps a drive from being stopped.
};

/// Of what is given beside an axis: `is` is what the file says of it, `given` the value of `option`.
Result<void> weigh(const Named& named, const Axis& axis, Source from, std::string_view option,
                   const Message& is, const Message& wanted) {
  const auto file = named.cabinet->file.filename().string();
  const auto& given = option == "--bus" ? named.settings->bus : named.settings->drive;
  if (from >= named.from && !named.way_out)
    return fail(Errc::usage,
                message("{} is {} by {}, not {}", as_it_is(axis.name), is, as_it_is(file), wanted),
                message("{}, or change the file", without(from, option)));
  add_once(*named.notices, message("{} ({}) is not used: {} says it of each axis", name_of(from, option),
                                   as_it_is(given), as_it_is(file)));
  return {};
}

/// What is given beside an axis must not say otherwise than the file, unless the line is stronger.
Result<void> check_given(const Named& named, const Axis& axis) {
  const auto& settings = *named.settings;
  const auto& bus = *named.cabinet->bus(axis.bus);
  if (!settings.bus.empty() && bus_given(*named.cabinet, settings.bus) != &bus)
    if (const auto right = weigh(named, axis, settings.bus_from, "--bus",
                                 message("on bus {} ({})", as_it_is(bus.name), as_it_is(bus.url)),
                                 message("on {}", as_it_is(settings.bus)));
        !right)
      return right;
  if (!settings.drive.empty() && settings.drive != axis.family)
    if (const auto right = weigh(named, axis, settings.drive_from, "--drive", Verbatim{axis.family},
                                 Verbatim{settings.drive});
        !right)
      return right;
  if (const auto turn = check_counts(*named.cabinet, axis, *named.arguments, "turn", axis.turn); !turn)
    return turn;
  return check_counts(*named.cabinet, axis, *named.arguments, "encoder", axis.encoder);
}

/// Axes of one bus and family go together; those that come first in the file go first.
Result<std::vector<LinePart>> parts_by_axis(const Named& named, const std::vector<const Axis*>& axes) {
  std::vector<LinePart> out;
  for (const auto* axis : axes) {
    if (const auto fits = check_given(named, *axis); !fits) return fail(fits.error());
    const auto same = std::find_if(out.begin(), out.end(), [&](const LinePart& part) {
      return part.axes.front()->bus == axis->bus && part.axes.front()->family == axis->family;
    });
    if (same != out.end()) {
      same->axes.push_back(axis);
      continue;
    }
    out.push_back(on_bus(*named.cabinet, *named.settings, *named.cabinet->bus(axis->bus)));
    out.back().axes.push_back(axis);
    out.back().settings.drive = axis->family;
  }
  for (auto& part : out) part.settings.nodes = numbers_of(part.axes);
  return out;
}

/// Beside a file that was named, `all` are the axes that it has on the bus.
bool means_axes(const command::Command& command, const Settings& settings) {
  const bool file_named =
      settings.cabinet_from != Source::folder && settings.cabinet_from >= settings.bus_from;
  return file_named && equals_nocase(settings.nodes, "all") && includes(command.needs, Needs::node) &&
         !command.to_all;
}

/// Numbers on one bus: those that are axes are what the file says.
Result<std::vector<LinePart>> parts_by_number(const Named& named, const command::Command& command,
                                              const cabinet::Bus& bus) {
  const auto& cabinet = named.cabinet;
  const auto& settings = named.settings;
  std::vector<const Axis*> axes;
  if (means_axes(command, *settings) && !settings->bus.empty()) {
    for (const auto& axis : cabinet->axes)
      if (axis.bus == bus.name) axes.push_back(&axis);
    return parts_by_axis(named, axes);
  }
  const bool numbers = !settings->nodes.empty() && !equals_nocase(settings->nodes, "all");
  const auto nodes = numbers ? parse_nodes(settings->nodes) : Result<std::vector<std::uint8_t>>();
  if (!nodes) return fail(nodes.error());
  for (const auto node : *nodes)
    if (const auto* axis = cabinet->at(bus.name, node)) axes.push_back(axis);
  if (!axes.empty() && axes.size() == nodes->size()) return parts_by_axis(named, axes);
  return std::vector{on_bus(*cabinet, *settings, bus)};
}

/// A file that lies in some folder above must not decide where a line without a name writes or moves.
Result<void> check_plain(const Cabinet& cabinet, const cabinet::Bus& bus, const command::Command& command,
                         const command::Arguments& arguments, const Settings& settings) {
  const bool changes = command.effect_with(arguments) > command::Effect::reads && !settings.dry_run;
  if (!changes) return {};
  return fail(Errc::usage,
              message("which bus? '{}' changes {}, and the line names neither an axis nor a bus",
                      as_it_is(command.path),
                      command.effect_with(arguments) == command::Effect::links ? "an interface" : "a drive"),
              message("add --bus {} ({}, by {}), or name the axes", as_it_is(bus.name), as_it_is(bus.url),
                      as_it_is(cabinet.file.string())));
}

/// It sets bus, family and limits of lines that do not name it.
Result<void> check_cabinet_found(const std::filesystem::path& file) {
  return check_found_file(file, message("nothing of this cabinet file was used; if you trust it, name it: "
                                        "--cabinet {0}, or SERVOCTL_CABINET={0}",
                                        as_it_is(file.string())));
}

}  // namespace

Result<const Cabinet*> CabinetHolder::get(const Settings& settings) {
  namespace fs = std::filesystem;
  std::error_code error;
  auto file = settings.cabinet;
  const bool named = !file.empty();
  if (!named) {
    if (!found_ || !searches_once_) found_ = cabinet::find_cabinet(fs::current_path(error));
    file = *found_;
  }
  if (file.empty()) {
    cabinet_.reset();
    return nullptr;
  }
  if (!named)
    if (const auto trusted = check_cabinet_found(file); !trusted) return fail(trusted.error());
  const auto written = fs::last_write_time(file, error);
  const auto size = error ? 0 : fs::file_size(file, error);
  if (cabinet_ && file == file_ && !error && written == written_ && size == size_) return &*cabinet_;
  auto read = cabinet::read_cabinet(file);
  if (!read) return fail(read.error());
  cabinet_ = std::move(*read);
  file_ = std::move(file);
  written_ = written;
  size_ = size;
  return &*cabinet_;
}

LinePart on_bus(const Cabinet& cabinet, const Settings& settings, const cabinet::Bus& bus) {
  LinePart out{settings, {}};
  out.settings.bus = bus.url;
  out.settings.of_cabinet = true;
  out.settings.names = names_on(cabinet, bus.name);
  for (const auto& axis : cabinet.axes)
    if (axis.bus == bus.name) out.on_bus.push_back(&axis);
  return out;
}

bool names_axes(const std::string& nodes) {
  return !nodes.empty() && !parse_nodes(nodes) && std::any_of(nodes.begin(), nodes.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalpha(byte) != 0;
  });
}

std::vector<std::string> with_axis_option(std::vector<std::string> words, const command::Command& command,
                                          std::size_t after, const Cabinet& cabinet) {
  if (!includes(command.needs, Needs::node) || after >= words.size()) return words;
  for (const auto& word : words)
    if (word.starts_with("-n") || word.starts_with("--node")) return words;
  const auto parts = split(std::string_view(words[after]), ',');
  if (parts.empty() ||
      !std::all_of(parts.begin(), parts.end(), [&](auto part) { return cabinet.knows(part); }))
    return words;
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(after), "-n");
  return words;
}

Result<std::vector<LinePart>> parts_of(const Cabinet& cabinet, const command::Command& command,
                                       const command::Arguments& arguments, const Settings& settings,
                                       std::vector<Message>& notices) {
  Named named{&cabinet, &arguments, &settings, settings.nodes_from, &notices, command.way_out};
  if (names_axes(settings.nodes)) {
    const auto axes = cabinet.select(settings.nodes);
    if (!axes) return fail(axes.error());
    return parts_by_axis(named, *axes);
  }
  named.from =
      settings.bus.empty() ? settings.cabinet_from : std::max(settings.cabinet_from, settings.bus_from);
  if (const auto* bus = cabinet.bus(settings.bus)) return parts_by_number(named, command, *bus);
  if (!settings.bus.empty() || !includes(command.needs, Needs::bus)) return std::vector<LinePart>();
  // Simulated drives do not go where the real ones are unless somebody says so.
  if (command.opens_bus) return std::vector<LinePart>();
  if (equals_nocase(settings.nodes, "all") && includes(command.needs, Needs::node) && !command.to_all) {
    const auto axes = cabinet.select("all");
    if (!axes) return fail(axes.error());
    named.from = settings.nodes_from;
    return parts_by_axis(named, *axes);
  }
  if (cabinet.buses.size() == 1) {
    const auto& bus = cabinet.buses.front();
    if (const auto plain = check_plain(cabinet, bus, command, arguments, settings); !plain)
      return fail(plain.error());
    return parts_by_number(named, command, bus);
  }
  std::vector<LinePart> out;
  for (const auto& bus : cabinet.buses) out.push_back(on_bus(cabinet, settings, bus));
  // The file it writes is of one bus at a time.
  const bool makes_file = command.path == "cabinet init";
  const bool looks = command.effect_with(arguments) <= command::Effect::reads && settings.nodes.empty();
  if (looks && !makes_file) return out;
  std::vector<std::string> names;
  for (const auto& bus : cabinet.buses) names.push_back(formatted("`--bus {}`", bus.name));
  return fail(
      Errc::usage,
      message("which bus? {} has {}", as_it_is(cabinet.file.filename().string()), cabinet.buses.size()),
      message("add {}, or name the axes", one_of(names)));
}

std::vector<OptionOfAxis> add_axis_options(std::span<const Axis* const> axes, const command::Command& command,
                                           command::Arguments& arguments) {
  using Get = std::string (*)(const Axis&);
  struct Row {
    OptionOfAxis names;
    Get get;
  };
  const Row rows[] = {
      {{"--turn", "turn"},
       [](const Axis& axis) { return axis.turn ? std::to_string(*axis.turn) : std::string(); }},
      {{"--encoder", "encoder"},
       [](const Axis& axis) { return axis.encoder ? std::to_string(*axis.encoder) : std::string(); }},
      {{"--limit", "limits.speed"}, [](const Axis& axis) { return axis.limits.speed; }},
      {{"--max-torque", "limits.torque"}, [](const Axis& axis) { return axis.limits.torque; }},
      {{"--window", "limits.window"}, [](const Axis& axis) { return axis.limits.window; }},
      {{"--max-following-error", "limits.following_error"},
       [](const Axis& axis) { return axis.limits.following_error; }}};
  std::vector<OptionOfAxis> out;
  for (const auto& row : rows) {
    if (axes.empty() || arguments.has(row.names.option)) continue;
    const auto takes = std::any_of(command.parameters.begin(), command.parameters.end(),
                                   [&](const command::Parameter& p) { return p.name == row.names.option; });
    const auto value = row.get(*axes.front());
    const bool same =
        std::all_of(axes.begin(), axes.end(), [&](const Axis* axis) { return row.get(*axis) == value; });
    if (!takes || !same || value.empty()) continue;
    arguments.add(row.names.option, value);
    out.push_back(row.names);
  }
  return out;
}

}  // namespace servoctl::cli
