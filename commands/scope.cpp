#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "pdo/scope_mapping.hpp"
#include "report/svg.hpp"
#include "traffic/channel_record.hpp"
#include "traffic/listening.hpp"
#include "traffic/sampler.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Duration kDefaultLength = std::chrono::seconds(2);
constexpr Duration kScopePeriod = std::chrono::milliseconds(1);

constexpr Parameter kScopeParameters[] = {
    {.name = "object",
     .help = "address, name or parameter number",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--for", .help = "how long (default 2s)", .kind = Kind::duration},
    {.name = "--map", .help = "map them into an unused TPDO meanwhile", .kind = Kind::flag},
    {.name = "--every", .help = "period of that TPDO (default 1ms)", .kind = Kind::duration},
    {.name = "--csv", .help = "write the samples to this file", .kind = Kind::file},
    {.name = "--svg", .help = "plot them to this file", .kind = Kind::file},
    {.name = "--plot", .help = "plot them here", .kind = Kind::flag},
};

/// So long after an object came by itself it is not read by SDO: the next one is on its way.
constexpr Duration kPdoPatience = std::chrono::milliseconds(100);

/// Samples as fast as the bus and the drives allow: takes every value that comes by itself, and reads by SDO,
/// one after the other, what does not. Each value has the time of its own frame.
class Scope {
 public:
  Scope(Context& context, traffic::Sampler& sampler) : session_(context.session), sampler_(&sampler) {
    for (const auto& channel : sampler.channels()) records_.emplace_back(channel);
    last_.resize(records_.size());
  }

  Result<void> run(Duration length) {
    begin_ = session_->now();
    end_ = begin_ + length;
    due_.assign(records_.size(), begin_);
    traffic::Listener listener;
    listener.on_pause = [&] { gather(); };
    listener.next = [&] { return *std::min_element(due_.begin(), due_.end()); };
    listener.on_time = [&](TimePoint now) {
      gather();
      return look(now);
    };
    auto ended = traffic::listen(*session_, length, listener);
    gather();
    seconds_ = std::chrono::duration<double>(session_->now() - begin_).count();
    interrupted_ = session_->options().cancelled && session_->options().cancelled();
    if (!ended && ended.error().code == Errc::interrupted) ended = {};
    if (ended) ended = check_sampled();
    return ended;
  }

  std::span<const traffic::ChannelRecord> records() const { return records_; }
  /// The last sample of each channel.
  std::span<const traffic::Sample> last() const { return last_; }
  double seconds() const { return seconds_; }

 private:
  void add(const traffic::Sample& sample, TimePoint next) {
    records_[sample.channel].add(std::chrono::duration<double>(sample.time - begin_).count(), sample);
    last_[sample.channel] = sample;
    due_[sample.channel] = next;
  }

  /// What came before the beginning belongs to no record.
  void gather() {
    for (const auto& sample : sampler_->gather())
      if (sample.time >= begin_ && sample.time < end_) add(sample, sample.time + kPdoPatience);
  }

  /// A drive that does not give the objects at the first look ends it, and so does one that gives something
  /// else than numbers; later on a gap stays, unless it is the bus that is lost.
  Result<void> look(TimePoint now) {
    std::vector<std::size_t> wanted;
    for (std::size_t i = 0; i < due_.size(); ++i)
      if (due_[i] <= now) wanted.push_back(i);
    if (wanted.empty()) return {};
    const bool first = std::exchange(first_, false);
    const auto samples = sampler_->read(wanted);
    gather();
    if (const auto* ended = traffic::end_of_looks(samples)) return fail(*ended);
    for (const auto& sample : samples) {
      const auto i = sample.channel;
      if (!sample.bytes && first) return fail(sample.bytes.error());
      if (first)
        if (const auto number = traffic::check_number(sampler_->channels()[i], *sample.bytes); !number)
          return number;
      // One came by itself meanwhile.
      if (due_[i] > now) continue;
      // After the first look those that come by themselves get their chance.
      const bool wait = first && sampler_->is_carried(i);
      add(sample, wait ? session_->now() + kPdoPatience : session_->now());
    }
    return {};
  }

  Result<void> check_sampled() const {
    const bool any = std::any_of(records_.begin(), records_.end(),
                                 [](const traffic::ChannelRecord& r) { return r.statistics().count() > 0; });
    if (any || interrupted_) return {};
    return fail(Errc::negative, "no samples were taken in this time", "use a longer --for");
  }

  session::Session* session_;
  traffic::Sampler* sampler_;
  std::vector<traffic::ChannelRecord> records_;
  std::vector<traffic::Sample> last_;
  std::vector<TimePoint> due_;  ///< When each channel is to be read by SDO.
  TimePoint begin_{};
  TimePoint end_{};
  double seconds_ = 0;
  bool first_ = true;
  bool interrupted_ = false;
};

/// With --map: spare TPDOs carry the objects until the answer is destroyed. A node where that cannot be is
/// told, and read by SDO.
Result<std::vector<std::unique_ptr<pdo::ScopeMapping>>> map_objects(Context& context,
                                                                    const Arguments& arguments) {
  std::vector<std::unique_ptr<pdo::ScopeMapping>> out;
  const auto period = duration_option(arguments, "--every");
  if (!period) return fail(period.error());
  if (!arguments.has("--map")) return out;
  if (context.read_only || context.dry_run)
    return fail(Errc::refused,
                "--map changes a TPDO of the drive, which --read-only and --dry-run do not allow",
                "without --map the objects are read by SDO");
  if (const auto right = context.hold_family(context.nodes, context.profile, true); !right)
    return fail(right.error());
  std::string nodes;
  for (const auto node : context.nodes) append(nodes, formatted("{}", node));
  if (const auto sure = context.confirm(formatted(
          "Map the objects into an unused TPDO of node {} while sampling, and restore it afterwards?",
          nodes));
      !sure)
    return fail(sure.error());
  for (const auto node : context.nodes) {
    out.push_back(std::make_unique<pdo::ScopeMapping>(context, node));
    const auto mapped = out.back()->begin(arguments.all("object"), period->value_or(kScopePeriod));
    if (mapped) continue;
    if (mapped.error().code == Errc::interrupted) return fail(mapped.error());
    context.notices.push_back(message("read by SDO, not mapped: {}{}",
                                      pdo::reason_naming(node, mapped.error()),
                                      mapped.error().hint.empty() ? "" : " (" + mapped.error().hint + ")"));
  }
  return out;
}

/// What the dictionary says is refused before anything is sent.
Result<void> check_names(const Context& context, const Arguments& arguments) {
  std::vector<traffic::Channel> channels;
  for (const auto& name : arguments.all("object")) {
    const auto target = drive::resolve(context.profile, name, drive::Match::part);
    if (!target) return fail(target.error());
    channels.push_back({.node = context.nodes.front(), .target = *target, .name = name});
    if (const auto number = traffic::check_number(channels.back()); !number) return number;
  }
  const auto why = arguments.has("--svg") ? traffic::no_plot_text(channels, "--svg") : std::string();
  return why.empty() ? Result<void>()
                     : fail(Errc::usage, why, "leave it out; the result lists their values in words");
}

Result<void> write_files(const Arguments& arguments, std::span<const Series> series,
                         std::span<const Series> plotted) {
  if (series.empty()) return {};
  if (arguments.has("--csv"))
    if (const auto done =
            write_file_atomically(std::string(arguments.text("--csv")), traffic::series_csv(series));
        !done)
      return done;
  if (arguments.has("--svg") && !plotted.empty())
    return write_file_atomically(std::string(arguments.text("--svg")), report::svg_plot(plotted));
  return {};
}

Result<Value> run_scope(Context& context, const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (const auto numbers = check_names(context, arguments); !numbers) return fail(numbers.error());
  const auto mapping = map_objects(context, arguments);
  if (!mapping) return fail(mapping.error());
  auto sampler = traffic::Sampler::make(context, arguments.all("object"));
  if (!sampler) return fail(sampler.error());
  Scope scope(context, *sampler);
  const auto recorded = scope.run(length->value_or(kDefaultLength));
  for (const auto& each : *mapping) each->end();
  const auto series = traffic::series_of(scope.records());
  // What was sampled before something broke is worth keeping.
  const auto plotted = traffic::plotted_series(scope.records());
  const auto written = write_files(arguments, series, plotted);
  if (!recorded) return fail(recorded.error());
  if (!written) return fail(written.error());
  for (auto& error : traffic::failures_of(scope.last())) context.errors.push_back(std::move(error));
  report::Record out{{"seconds", std::round(scope.seconds() * 1000) / 1000},
                     {"objects", traffic::sampling_table(scope.records())}};
  traffic::add_words(out, context, scope.records());
  for (const auto& [option, written_series] : {std::pair("--csv", &series), std::pair("--svg", &plotted)}) {
    const bool is_written = arguments.has(option) && !written_series->empty();
    out.push_back({option + 2, is_written ? Value(arguments.text(option)) : Value(),
                   is_written ? report::Show::everywhere : report::Show::json});
  }
  out.push_back({"plot", report::Plot{series}, report::Show::json});
  if (arguments.has("--plot"))
    if (auto why = traffic::no_plot_text(sampler->channels(), "--plot"); !why.empty())
      context.notices.push_back(std::move(why));
  if (arguments.has("--plot") && !plotted.empty())
    out.push_back({"plot_text", report::Plot{plotted}, report::Show::text, "plot"});
  return Value(std::move(out));
}

constexpr Example kScopeExamples[] = {
    {"scope 0x6064 0x606C --for 2s --svg jog.svg --csv jog.csv -n 1 -d gsd600",
     "as fast as the bus allows, as a plot and a table"},
    {"scope 0x606C 0x6077 --map --every 2ms --for 1s --plot -n 1 -d gsd600",
     "every 2 ms by a TPDO of its own; asks, and puts it back"},
};

}  // namespace

extern const Command kScope;
const Command kScope{
    .path = "scope",
    .summary = "Record values of objects as fast as the bus allows",
    .details =
        "Uses every TPDO that carries the objects; without one it reads them by SDO, one after the other. "
        "--map asks, then maps them into an unused TPDO, sent every millisecond (--every), for a higher "
        "sampling rate, and restores it at the end; without --map nothing in the drive is changed. Each "
        "value has the arrival time of its own frame. The samples go to a file (--csv, with empty cells "
        "where there is no value at that time; --svg) or are plotted (--plot); with --json they are in the "
        "result. A drive that no longer answers at the end sets the exit code."
        " Bit fields such as statusword and digital inputs are shown in words: each value they had is listed at the end, and none is plotted.",
    .parameters = kScopeParameters,
    .examples = kScopeExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_scope,
    .goes_on = true,
    .on_registers = true,
};

}  // namespace servoctl::commands
