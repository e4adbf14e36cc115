#include "sim/esc_cell_options.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"

namespace servoctl::sim {
namespace {

struct Task {
  const CellSpec* spec;
  const CellSpec::Option* option;
  EscCell* cell;
  TimePoint now;

  /// `'lose=x': …`.
  tl::unexpected<Error> wrong(const Message& what) const {
    return spec->wrong(message("'{}={}': {}", as_it_is(option->key), as_it_is(option->value), what));
  }
};

Result<void> late_answers(const Task& task) {
  const auto time = time_of(*task.spec, *task.option);
  if (!time) return fail(time.error());
  for (const auto& slave : task.cell->slaves) slave->faults().answer_delay = *time;
  return {};
}

Result<void> lie(const Task& task) {
  const auto words = lies_of(*task.spec, *task.option, kRingLies);
  if (!words) return fail(words.error());
  EscLies lies;
  // Those of kRingLies: the text of the option goes.
  for (const auto word : *words) lies.words.push_back(*std::find(kRingLies.begin(), kRingLies.end(), word));
  for (const auto& option : task.spec->options) {
    if (option.key != "lie-after" && option.key != "lie-for") continue;
    const auto time = time_of(*task.spec, option);
    if (!time) return fail(time.error());
    if (option.key == "lie-after") lies.after = *time;
    if (option.key == "lie-for") lies.length = *time;
  }
  for (const auto& slave : task.cell->slaves) slave->plan_lies(lies);
  return {};
}

Result<void> set_clock(const Task& task) {
  if (task.option->value != "32") return task.wrong("distributed clocks of 32 bits are clock=32");
  for (const auto& slave : task.cell->slaves) slave->registers().set_clock_bits(32);
  return {};
}

Result<void> fall_silent(const Task& task) {
  const auto time = time_of(*task.spec, *task.option);
  if (!time) return fail(time.error());
  task.cell->ring.plan({task.now + *time, RingEvent::Kind::cut_cable, 0});
  return {};
}

/// Empty when it is no count.
std::optional<std::uint32_t> count_of(std::string_view text) {
  const auto count = parse_digits(text, 10);
  if (!count || *count == 0 || *count > 1'000'000'000) return std::nullopt;
  return static_cast<std::uint32_t>(*count);
}

Result<void> lose_frames(const Task& task) {
  const auto count = count_of(task.option->value);
  if (!count) return task.wrong("every how many frames one is lost is a number from 1");
  task.cell->ring.faults().loses_every = *count;
  return {};
}

Result<void> shorten_counters(const Task& task) {
  const auto count = count_of(task.option->value);
  if (!count) return task.wrong("every how many frames one has short counters is a number from 1");
  task.cell->ring.faults().shortens_every = *count;
  return {};
}

Result<void> fill_mailbox(const Task& task) {
  if (task.option->value != "full") return task.wrong("the one fault of a mailbox is mailbox=full");
  for (const auto& slave : task.cell->slaves) slave->faults().mailbox_stays_full = true;
  return {};
}

Result<void> send_emergencies(const Task& task) {
  const auto count = count_of(task.option->value);
  if (!count) return task.wrong("before how many answers an emergency comes is a number from 1");
  for (const auto& slave : task.cell->slaves) slave->faults().emergencies = *count;
  return {};
}

Result<void> refuse_free_run(const Task& task) {
  if (task.option->value != "no") return task.wrong("drives that need SYNC0 are free-run=no");
  for (const auto& slave : task.cell->slaves) slave->faults().refuses_free_run = true;
  return {};
}

Result<void> plan_fall(const Task& task) {
  const auto text = task.option->value;
  const auto at = text.find('@');
  PlannedFall fall;
  if (at != std::string_view::npos) {
    const auto code = parse_integer(text.substr(0, at));
    if (!code || code->negative || code->magnitude > 0xFFFF)
      return task.wrong("a fall is TIME or CODE@TIME, such as fall=0x1B@5s");
    fall.code = static_cast<std::uint16_t>(code->magnitude);
  }
  const auto time = parse_duration(at == std::string_view::npos ? text : text.substr(at + 1));
  if (!time) return task.wrong("a fall is TIME or CODE@TIME, such as fall=0x1B@5s");
  fall.time = task.now + *time;
  for (const auto& slave : task.cell->slaves) slave->plan_fall(fall);
  return {};
}

/// `2@5s-8s`: something at a position, from a time until another, or for ever.
struct Window {
  std::size_t slave = 0;  ///< From 0.
  Duration from{};
  std::optional<Duration> to;
};

std::optional<Window> window_of(std::string_view text, std::size_t slaves) {
  const auto at = text.find('@');
  if (at == std::string_view::npos) return std::nullopt;
  const auto position = parse_digits(text.substr(0, at), 10);
  const auto times = text.substr(at + 1);
  const auto dash = times.find('-');
  const auto from = parse_duration(times.substr(0, dash));
  if (!position || *position == 0 || *position > slaves || !from) return std::nullopt;
  Window out{static_cast<std::size_t>(*position - 1), *from, {}};
  if (dash == std::string_view::npos) return out;
  out.to = parse_duration(times.substr(dash + 1));
  return out.to && *out.to > out.from ? std::optional(out) : std::nullopt;
}

Result<void> plan_window(const Task& task, RingEvent::Kind begin, RingEvent::Kind end) {
  const auto window = window_of(task.option->value, task.cell->slaves.size());
  if (!window)
    return task.wrong(
        message("it is POSITION@TIME or POSITION@FROM-TO, with a position of 1 to {}, such as "
                "{}=1@5s-8s",
                task.cell->slaves.size(), task.option->key));
  task.cell->ring.plan({task.now + window->from, begin, window->slave});
  if (window->to) task.cell->ring.plan({task.now + *window->to, end, window->slave});
  return {};
}

Result<void> cycle_power(const Task& task) {
  return plan_window(task, RingEvent::Kind::power_off, RingEvent::Kind::power_on);
}

Result<void> cut_cable(const Task& task) {
  return plan_window(task, RingEvent::Kind::cut_cable, RingEvent::Kind::join_cable);
}

struct Way {
  std::string_view key;
  Result<void> (*apply)(const Task&);  ///< Null: somebody else has applied it.
};

constexpr std::array<Way, 19> kWays{{{"state", nullptr},
                                     {"fault", nullptr},
                                     {"counts", nullptr},
                                     {"panel", nullptr},
                                     {"sii", nullptr},
                                     {"delay", late_answers},
                                     {"silent", fall_silent},
                                     {"lose", lose_frames},
                                     {"short", shorten_counters},
                                     {"mailbox", fill_mailbox},
                                     {"emergency", send_emergencies},
                                     {"fall", plan_fall},
                                     {"free-run", refuse_free_run},
                                     {"clock", set_clock},
                                     {"lie", lie},
                                     {"lie-after", nullptr},
                                     {"lie-for", nullptr},
                                     {"power", cycle_power},
                                     {"cut", cut_cable}}};

}  // namespace

Result<SiiFault> sii_fault_of(const CellSpec& spec) {
  struct Named {
    std::string_view name;
    SiiFault fault;
  };
  constexpr Named kFaults[] = {{"checksum", SiiFault::checksum},
                               {"blank", SiiFault::blank},
                               {"cut-short", SiiFault::cut_short},
                               {"mailboxes", SiiFault::mailboxes},
                               {"mute", SiiFault::mute}};
  auto out = SiiFault::none;
  for (const auto& option : spec.options) {
    if (option.key != "sii") continue;
    const auto* const found = std::find_if(std::begin(kFaults), std::end(kFaults),
                                           [&](const auto& f) { return f.name == option.value; });
    if (found == std::end(kFaults))
      return spec.wrong(
          message("'sii={}': what is wrong with an SII is checksum, blank, cut-short, mailboxes or mute",
                  as_it_is(option.value)));
    out = found->fault;
  }
  return out;
}

Result<void> apply_option(const CellSpec& spec, const CellSpec::Option& option, EscCell& cell,
                          TimePoint now) {
  std::vector<DriveModel*> models;
  for (const auto& slave : cell.slaves) models.push_back(&slave->model());
  const auto is_applied = apply_drive_option(spec, option, models, now);
  if (!is_applied) return fail(is_applied.error());
  const auto* const way =
      std::find_if(kWays.begin(), kWays.end(), [&](const auto& w) { return w.key == option.key; });
  if (way != kWays.end())
    return way->apply == nullptr ? Result<void>() : way->apply({&spec, &option, &cell, now});
  std::vector<std::string> keys;
  for (const auto& known : kWays) keys.emplace_back(known.key);
  return spec.wrong(
      message("'{}' is not an option of a simulated ring: use {}", as_it_is(option.key), one_of(keys)));
}

}  // namespace servoctl::sim
