#include <algorithm>
#include <memory>

#include "base/format.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "session/identify.hpp"
#include "show/records.hpp"
#include "show/sample_writer.hpp"
#include "traffic/channel_record.hpp"
#include "traffic/listening.hpp"
#include "traffic/sampler.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Duration kDefaultEvery = std::chrono::milliseconds(100);

constexpr Parameter kWatchParameters[] = {
    {.name = "object",
     .help = "address, name or parameter number; several are shown side by side",
     .kind = Kind::object,
     .required = true,
     .many = true},
    {.name = "--every", .help = "sampling period (default 100ms)", .kind = Kind::duration},
    kForOption,
    {.name = "--changes", .help = "only when a value has changed", .kind = Kind::flag},
    {.name = "--plot", .help = "plot the values at the end", .kind = Kind::flag},
};

/// Samples as they are shown: the values of one node at one time.
class WatchingValues {
 public:
  WatchingValues(Context& context, traffic::Sampler& sampler, bool changes)
      : context_(&context), sampler_(&sampler), changes_(changes), writer_(context) {
    for (const auto& channel : sampler.channels()) records_.emplace_back(channel);
    if (!changes)
      view_ = context.open_view(
          {.columns = {{.title = "node", .right = true}, {.title = "object"}, {.title = "value"}}});
  }

  /// Errc of the first look when nothing could be read; a failure later on is shown and counted, unless it is
  /// the bus that is lost.
  Result<void> look(Duration since) {
    const auto samples = sampler_->take();
    if (const auto* ended = traffic::end_of_looks(samples)) return fail(*ended);
    const auto failed =
        std::find_if(samples.begin(), samples.end(), [](const traffic::Sample& s) { return !s.bytes; });
    if (looks_++ == 0 && failed != samples.end()) return fail(failed->bytes.error());
    const auto seconds = std::chrono::duration<double>(since).count();
    for (std::size_t i = 0; i < samples.size(); ++i) records_[i].add(seconds, samples[i]);
    if (view_) show(samples);
    for (const auto node : context_->nodes)
      if (!view_) show(node, seconds, samples);
    before_ = samples;
    writer_.flush();
    return {};
  }

  bool has_looked() const { return !before_.empty(); }
  bool is_over() const { return view_ && view_->is_over(); }
  void refresh() {
    if (view_) view_->refresh(context_->session->now());
  }

  /// `lost`: the bus is, so that what failed last says nothing of the drives.
  Value result(bool plot, bool lost) {
    view_.reset();
    if (!lost)
      for (auto& error : traffic::failures_of(before_)) context_->errors.push_back(std::move(error));
    report::Record out{{"objects", traffic::sampling_table(records_)}};
    traffic::add_words(out, *context_, records_);
    if (auto plotted = traffic::plotted_series(records_); plot && !plotted.empty())
      out.push_back({"plot", report::Plot{std::move(plotted)}, report::Show::text});
    out.push_back(
        {"samples", context_->keeps_samples ? Value(writer_.take_kept()) : Value(), report::Show::json});
    return out;
  }

 private:
  bool has_changed(std::size_t i, const std::vector<traffic::Sample>& samples) const {
    if (before_.empty() || before_[i].bytes.has_value() != samples[i].bytes.has_value()) return true;
    return samples[i].bytes && *samples[i].bytes != *before_[i].bytes;
  }

  void show(const std::vector<traffic::Sample>& samples) {
    for (const auto& sample : samples) {
      const auto& channel = sampler_->channels()[sample.channel];
      const auto node = formatted("{}", channel.node);
      const auto row = formatted("{}", sample.channel);
      if (!sample.bytes) {
        view_->set(row, {node, channel.name, "-"});
        continue;
      }
      const auto value = decoded(channel, sample);
      const auto label = show::brief_label(value, context_->chinese);
      view_->set(row, {node, channel.name, label.empty() ? value.text : value.text + " " + label},
                 channel.is_word() ? std::nullopt : show::plotted(value.value));
    }
  }

  void show(std::uint8_t node, double seconds, const std::vector<traffic::Sample>& samples) {
    report::List values;
    std::string line = formatted("{:10.3f}", seconds);
    if (context_->nodes.size() > 1) line += formatted(" {:3}", node);
    bool changed = !changes_;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto& channel = sampler_->channels()[i];
      if (channel.node != node) continue;
      changed = changed || has_changed(i, samples);
      line += "  " + text_of(channel, samples[i]);
      if (writer_.wants_records()) values.emplace_back(record_of(channel, samples[i]));
    }
    if (!changed) return;
    if (writer_.wants_records())
      writer_.add_record([&](report::JsonWriter& json) {
        json.member("time", seconds);
        json.member("node", node);
        json.member("values", Value(std::move(values)));
      });
    else
      writer_.add_line(line);
  }

  std::string text_of(const traffic::Channel& channel, const traffic::Sample& sample) const {
    return channel.name + " " + (sample.bytes ? text_of(decoded(channel, sample)) : "-");
  }

  std::string text_of(const show::DecodedValue& value) const {
    const auto label = show::label_text(value, context_->chinese);
    return label.empty() ? value.text : value.text + " " + label;
  }

  /// Of a sample that has bytes.
  show::DecodedValue decoded(const traffic::Channel& channel, const traffic::Sample& sample) const {
    return traffic::decoded(*context_, channel, *sample.bytes);
  }

  report::Record record_of(const traffic::Channel& channel, const traffic::Sample& sample) const {
    const auto& address = channel.target.address;
    report::Record out{{"index", address.index},
                       {"sub", address.sub},
                       {"name", report::text_or_null(channel.target.label())}};
    if (!sample.bytes) {
      for (const auto* key : {"value", "raw", "unit", "si", "label", "by"}) out.push_back({key});
      out.push_back({"error", show::error_record(sample.bytes.error())});
      return out;
    }
    auto value = decoded(channel, sample);
    out.push_back({"value", std::move(value.value)});
    out.push_back({"raw", std::move(value.raw)});
    out.push_back({"unit", report::text_or_null(value.unit)});
    out.push_back({"si", std::move(value.familiar)});
    out.push_back({"label", std::move(value.label)});
    out.push_back({"by", sample.by_pdo ? "pdo" : "sdo"});
    out.push_back({"error"});
    return out;
  }

  Context* context_;
  traffic::Sampler* sampler_;
  bool changes_;
  show::SampleWriter writer_;
  std::vector<traffic::ChannelRecord> records_;
  std::vector<traffic::Sample> before_;
  std::unique_ptr<show::LiveView> view_;
  std::size_t looks_ = 0;
};

Result<Value> run_watch(Context& context, const Arguments& arguments) {
  const auto every = duration_option(arguments, "--every");
  if (!every) return fail(every.error());
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  // Behind a bus that was lost others may be there.
  if (context.profile != nullptr)
    (void)session::identify(*context.session, context.nodes, context.profile->rules);
  auto sampler = traffic::Sampler::make(context, arguments.all("object"));
  if (!sampler) return fail(sampler.error());
  if (arguments.has("--plot"))
    if (auto why = traffic::no_plot_text(sampler->channels(), "--plot"); !why.empty())
      context.notices.push_back(std::move(why));
  auto& session = *context.session;
  const auto period = every->value_or(kDefaultEvery);
  WatchingValues watching(context, *sampler, arguments.has("--changes"));
  const auto begin = session.now();
  auto next = begin;
  traffic::Listener listener;
  listener.next = [&] { return next; };
  listener.on_pause = [&] { watching.refresh(); };
  listener.is_over = [&] { return watching.is_over(); };
  listener.on_bus = session::BusReturn::to_people(session);
  listener.nodes = context.nodes;
  listener.on_time = [&](TimePoint now) -> Result<void> {
    const auto looked = watching.look(now - begin);
    // A drive that answers slowly is not asked for what was missed.
    next += (std::max(session.now() - next, Duration::zero()) / period + 1) * period;
    return looked;
  };
  const auto ended = traffic::listen(session, *length, listener);
  const bool whole = ended || ended.error().code == Errc::interrupted;
  const bool shown = whole || (watching.has_looked() && traffic::has_summary(ended, context.errors));
  if (!shown) return fail(ended.error());
  return watching.result(arguments.has("--plot"), !whole);
}

constexpr Example kWatchExamples[] = {
    {"watch 0x6064 0x606C -n 1 -d gsd600", "position and speed, until Ctrl-C or q"},
    {"watch statusword -n 1 -d gsd600 --changes", "a line when it changes"},
    {"watch 0x6077 --every 20ms --for 5s --plot -n 1 -d gsd600",
     "the torque for five seconds, plotted at the end"},
};

}  // namespace

extern const Command kWatch;
const Command kWatch{
    .path = "watch",
    .summary = "Show the values of objects over time",
    .details =
        "On a terminal a table that is updated in place, with a small plot of each value (keys: space pauses, s "
        "sorts, q quits); elsewhere, and with --changes, one line per node at each --every; until --for is over "
        "or Ctrl-C. Values in a TPDO are taken from "
        "it; the rest is read by SDO. A bus that is lost is waited for until the end. Then it shows the number of values of each object, the minimum, "
        "mean and maximum; --plot plots them. `-o jsonl` gives one document per sample. A drive that no "
        "longer answers at the end sets the exit code."
        " Bit fields such as statusword and digital inputs are shown in words: each value they had is listed at the end, and none is plotted.",
    .parameters = kWatchParameters,
    .examples = kWatchExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_watch,
    .goes_on = true,
    .on_registers = true,
};

}  // namespace servoctl::commands
