#include <cmath>
#include <utility>

#include "base/file.hpp"
#include "commands/command.hpp"
#include "commands/listening.hpp"
#include "commands/sampler.hpp"
#include "report/svg.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr Duration kDefaultLength = std::chrono::seconds(2);

constexpr Parameter kParameters[] = {
    {.name = "object",
     .help = "address, name or parameter number",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--for", .help = "how long (default 2s)", .kind = Kind::duration},
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
      const auto added = add(now);
      next = session_->now();
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
  auto sampler = Sampler::make(context, arguments.all("object"));
  if (!sampler) return tl::unexpected<Error>(sampler.error());
  Scope scope(context, *sampler);
  const auto recorded = scope.run(length->value_or(kDefaultLength));
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
        "other. The "
        "samples "
        "go into a file (--csv, --svg) or are drawn (--plot); with --json they are in the result. It changes "
        "nothing "
        "in "
        "the drive: `pdo map` puts objects into a TPDO, which makes the samples denser and their times "
        "exact.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run,
};

}  // namespace servoctl::commands
