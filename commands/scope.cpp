#include <fmt/format.h>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/file.hpp"
#include "commands/command.hpp"
#include "commands/listening.hpp"
#include "commands/sampler.hpp"
#include "commands/scope_mapping.hpp"
#include "report/svg.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr Duration kDefaultLength = std::chrono::seconds(2);
constexpr Duration kDefaultPeriod = std::chrono::milliseconds(1);

constexpr Parameter kParameters[] = {
    {.name = "object",
     .help = "address, name or parameter number",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--for", .help = "how long (default 2s)", .kind = Kind::duration},
    {.name = "--map", .help = "put them into a spare TPDO meanwhile", .kind = Kind::flag},
    {.name = "--every", .help = "period of that TPDO (default 1ms)", .kind = Kind::duration},
    {.name = "--csv", .help = "write the samples to this file", .kind = Kind::file},
    {.name = "--svg", .help = "draw them into this file", .kind = Kind::file},
    {.name = "--plot", .help = "draw them here", .kind = Kind::flag},
};

/// So long after TPDOs have brought all objects nothing is read by SDO: the next ones are on their way.
constexpr Duration kPdoPatience = std::chrono::milliseconds(100);

/// Samples as fast as the bus and the drives allow: with every TPDO that completes a set of values, else by
/// SDO, one read after the other.
class Scope {
 public:
  Scope(Context& context, Sampler& sampler) : session_(context.session), sampler_(&sampler) {
    for (const auto& channel : sampler.channels()) records_.emplace_back(channel);
  }

  Result<void> run(Duration length) {
    begin_ = session_->now();
    auto next = begin_;
    Listener listener;
    listener.on_frame = [&](const can::Frame& frame, TimePoint time) {
      if (!sampler_->on_frame(frame, time) || !sampler_->is_complete()) return;
      (void)add(time);
      next = time + kPdoPatience;
    };
    listener.next = [&] { return next; };
    listener.on_time = [&](TimePoint now) {
      const bool wait = first_ && sampler_->is_carried();
      const auto added = add(now);
      // After the first look the TPDOs get their chance, where there are any.
      next = wait ? begin_ + kPdoPatience : session_->now();
      return added;
    };
    const auto ended = listen(*session_, length, listener);
    seconds_ = std::chrono::duration<double>(session_->now() - begin_).count();
    if (!ended && ended.error().code == Errc::interrupted) return {};
    return ended;
  }

  std::span<const ChannelRecord> records() const { return records_; }
  double seconds() const { return seconds_; }

 private:
  /// A drive that does not give the objects at the first look ends it; later on a gap stays.
  Result<void> add(TimePoint time) {
    const auto samples = sampler_->take();
    const auto seconds = std::chrono::duration<double>(time - begin_).count();
    const bool first = std::exchange(first_, false);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const bool failed = !samples[i].bytes.has_value();
      if (failed && (first || samples[i].bytes.error().code == Errc::interrupted))
        return tl::unexpected<Error>(samples[i].bytes.error());
      records_[i].add(seconds, samples[i]);
    }
    return {};
  }

  session::Session* session_;
  Sampler* sampler_;
  std::vector<ChannelRecord> records_;
  TimePoint begin_{};
  double seconds_ = 0;
  bool first_ = true;
};

/// With --map: spare TPDOs carry the objects until the answer is destroyed. A node where that cannot be is
/// told, and read by SDO.
Result<std::vector<std::unique_ptr<ScopeMapping>>> map_objects(Context& context, const Arguments& arguments) {
  std::vector<std::unique_ptr<ScopeMapping>> out;
  const auto period = duration_option(arguments, "--every");
  if (!period) return tl::unexpected<Error>(period.error());
  if (!arguments.has("--map")) return out;
  if (context.read_only || context.dry_run)
    return fail(Errc::refused, "--map changes a TPDO of the drive, and that is forbidden",
                "without --map the objects are read by SDO");
  for (const auto node : context.nodes) {
    out.push_back(std::make_unique<ScopeMapping>(context, node));
    const auto mapped = out.back()->begin(arguments.all("object"), period->value_or(kDefaultPeriod));
    if (mapped) continue;
    if (mapped.error().code == Errc::interrupted) return tl::unexpected<Error>(mapped.error());
    context.notices.push_back(
        fmt::format("node {}: read by SDO, not mapped: {}{}", node, mapped.error().message,
                    mapped.error().hint.empty() ? "" : " (" + mapped.error().hint + ")"));
  }
  return out;
}

Result<void> write_files(const Arguments& arguments, std::span<const Series> series) {
  if (arguments.has("--csv"))
    if (const auto done = write_file_atomically(std::string(arguments.text("--csv")), series_csv(series));
        !done)
      return done;
  if (arguments.has("--svg"))
    return write_file_atomically(std::string(arguments.text("--svg")), report::svg_plot(series));
  return {};
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto length = duration_option(arguments, "--for");
  if (!length) return tl::unexpected<Error>(length.error());
  const auto mapping = map_objects(context, arguments);
  if (!mapping) return tl::unexpected<Error>(mapping.error());
  auto sampler = Sampler::make(context, arguments.all("object"));
  if (!sampler) return tl::unexpected<Error>(sampler.error());
  Scope scope(context, *sampler);
  const auto recorded = scope.run(length->value_or(kDefaultLength));
  for (const auto& each : *mapping) each->end();
  const auto series = series_of(scope.records());
  // What was sampled before something broke is worth keeping.
  const auto written = write_files(arguments, series);
  if (!recorded) return tl::unexpected<Error>(recorded.error());
  if (!written) return tl::unexpected<Error>(written.error());
  report::Record out{{"seconds", std::round(scope.seconds() * 1000) / 1000},
                     {"objects", sampling_table(scope.records())}};
  for (const auto* option : {"--csv", "--svg"})
    if (arguments.has(option)) out.push_back({option + 2, arguments.text(option)});
  out.push_back({"plot", report::Plot{series},
                 arguments.has("--plot") ? report::Show::everywhere : report::Show::json});
  return Value(std::move(out));
}

}  // namespace

extern const Command kScope;
const Command kScope{
    .path = "scope",
    .summary = "Record values of objects as fast as the bus allows",
    .details =
        "Takes every TPDO that carries the objects; without one it reads them by SDO, one read after the "
        "other. --map puts them into a TPDO that is not in use, sent every millisecond (--every), and puts "
        "it "
        "back at the end: samples are denser then and their times exact. The samples go into a file (--csv, "
        "--svg) or are drawn (--plot); with --json they are in the result. Without --map nothing in the "
        "drive "
        "is changed.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run,
};

}  // namespace servoctl::commands
