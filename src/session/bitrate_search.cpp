#include "session/bitrate_search.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include "base/format.hpp"
#include "can/controller_report.hpp"
#include "can/error_frame.hpp"

namespace servoctl::session {
namespace {

/// So many frames leave no doubt; a frame passes its checksum at a wrong bitrate once in 30,000 tries.
constexpr std::size_t kClearFrames = 3;
/// So many errors without a frame neither.
constexpr std::size_t kClearErrors = 20;
/// Between two looks at whether it was cancelled.
constexpr Duration kLook = std::chrono::milliseconds(50);

/// A controller that leaves its good state by listening heard what it could not read.
bool is_trouble(const can::Frame& frame) {
  if (can::parse_wire_error(frame)) return true;
  const auto report = can::parse_report(frame);
  return report == can::ControllerReport::error_passive || report == can::ControllerReport::error_warning ||
         report == can::ControllerReport::bus_off;
}

Heard::Verdict verdict_of(const Heard& heard) {
  if (heard.frames > 0 && heard.frames >= heard.errors) return Heard::Verdict::fits;
  return heard.errors > 0 ? Heard::Verdict::errors : Heard::Verdict::silent;
}

Error stopped_by_user() { return make_error(Errc::interrupted, "interrupted"); }

class Searching {
 public:
  Searching(can::LinkControl& link, const SearchOptions& options) : link_(&link), options_(&options) {}

  Result<Search> run() {
    Search out;
    for (const auto bitrate : options_->bitrates) {
      const auto heard = listen_at(bitrate);
      if (!heard) return fail(heard.error());
      out.heard.push_back(*heard);
      if (options_->told) options_->told(*heard);
      if (heard->verdict != Heard::Verdict::fits) continue;
      out.bitrate = bitrate;
      break;
    }
    return out;
  }

 private:
  /// The counters of the controller tell where its driver reports no error frames.
  std::size_t counted_errors() {
    const auto state = link_->state();
    return state && state->rx_errors ? *state->rx_errors : 0;
  }

  Result<Heard> listen_at(std::uint32_t bitrate) {
    Heard out{.bitrate = bitrate};
    if (const auto down = link_->change({.up = false}); !down) return fail(down.error());
    const auto set = link_->change({.up = true, .bitrate = bitrate, .listen_only = true});
    if (!set && set.error().code == Errc::usage && is_possible()) {
      out.verdict = Heard::Verdict::unreachable;
      return out;
    }
    if (!set) return fail(set.error());
    if (!has(bitrate)) {
      out.verdict = Heard::Verdict::unreachable;
      return out;
    }
    const auto bus = link_->listen();
    if (!bus) return fail(bus.error());
    auto heard = hear(**bus, options_->each, options_->cancelled, options_->listening);
    if (!heard) return heard;
    heard->bitrate = bitrate;
    heard->errors = std::max(heard->errors, counted_errors());
    heard->verdict = verdict_of(*heard);
    return heard;
  }

  /// The kernel takes a bitrate that its controller misses by 5 %.
  bool has(std::uint32_t bitrate) {
    const auto state = link_->state();
    return state && state->bitrate && *state->bitrate * 100ULL >= bitrate * 99ULL &&
           *state->bitrate * 99ULL <= bitrate * 100ULL;
  }

  /// Whether another bitrate may be had: it is not the kind or the mode that was refused.
  bool is_possible() {
    const auto state = link_->state();
    if (!state || state->kind != "can") return false;
    return link_->change({.listen_only = true}).has_value();
  }

  can::LinkControl* link_;
  const SearchOptions* options_;
};

}  // namespace

std::string_view name(Heard::Verdict verdict) {
  switch (verdict) {
    case Heard::Verdict::silent: return "silent";
    case Heard::Verdict::fits: return "frames";
    case Heard::Verdict::errors: return "errors only";
    case Heard::Verdict::unreachable: return "not possible";
  }
  return {};
}

std::span<const std::uint32_t> usual_bitrates() {
  static constexpr std::array<std::uint32_t, 9> kUsual{500'000, 1'000'000, 250'000, 125'000, 800'000,
                                                       100'000, 50'000,    20'000,  10'000};
  return kUsual;
}

Result<Heard> hear(can::Bus& bus, Duration time, const std::function<bool()>& cancelled,
                   const Listening& listening) {
  Heard out;
  const auto begin = bus.now();
  const auto end = begin + time;
  while (bus.now() < end && out.frames < kClearFrames && (out.frames > 0 || out.errors < kClearErrors)) {
    if (cancelled && cancelled()) return fail(stopped_by_user());
    if (listening) listening(std::chrono::duration<double>(bus.now() - begin) / time, begin, bus.now());
    const auto frame = bus.receive(std::min(end, bus.now() + kLook));
    if (!frame) return fail(frame.error());
    if (!*frame) continue;
    out.frames += !(*frame)->error;
    out.errors += is_trouble(**frame);
  }
  out.verdict = verdict_of(out);
  return out;
}

Result<Search> search_bitrate(can::LinkControl& link, const SearchOptions& options) {
  const auto before = link.state();
  if (!before) return fail(before.error());
  if (before->kind != "can" || before->can_listen_only == false) {
    const can::LinkChange wanted{.listen_only = true};
    return fail(can::link_refusal(link.name(), wanted, *before, EOPNOTSUPP, {}));
  }
  can::LinkKeeper keeper(link, *before);
  auto found = Searching(link, options).run();
  const auto back = keeper.put_back();
  if (!back && found) {
    auto error = back.error();
    error.message =
        message("{} could not be put back to what it was: {}", as_it_is(link.name()), error.message);
    return fail(std::move(error));
  }
  return found;
}

}  // namespace servoctl::session
