#include "trial/comm_trial.hpp"

#include <algorithm>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/run_delay.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/ethercat_network.hpp"
#include "session/open_bus.hpp"
#include "session/option_scope.hpp"
#include "session/stretch.hpp"
#include "show/notice.hpp"
#include "trial/figures.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using report::Criterion;
using report::Record;
using report::TestResult;

/// A node that has let so many reads in succession pass is not there: the rest would only cost time.
constexpr std::uint32_t kGone = 3;
constexpr std::uint32_t kHeartbeats = 4;
/// How far a heartbeat may be from its time: CiA 301 names no tolerance.
constexpr double kHeartbeatTolerance = 0.2;
/// From 96 on a controller warns (ISO 11898-1, 12.1.4).
constexpr int kMostErrors = 95;
constexpr Duration kLeastTolerance = std::chrono::milliseconds(10);

class Communication {
 public:
  Communication(show::Desk& desk, std::uint8_t node, const CommTrial& test)
      : desk_(&desk), session_(desk.session), node_(node), test_(test) {
    // Of a clock of its own no time is lost.
    constexpr auto kSame = std::chrono::milliseconds(1);
    const auto before = steady_now();
    const auto now = session_->now();
    const bool is_ours = now >= before - kSame && now <= steady_now() + kSame;
    if (!test_.own_delay && is_ours) test_.own_delay = run_delay;
    if (!test_.own_delay) test_.own_delay = [] { return Duration::zero(); };
  }

  Result<TestResult> run() {
    const auto begin = session_->now();
    out_.test = kCommTestName;
    out_.node = node_;
    take_notices();
    emergencies_ = reports_ = 0;
    boots_ = session_->watch().boots(node_);
    ring_ = session_->ethercat();
    frames_lost_ = ring_ != nullptr ? ring_->statistics().lost : 0;
    if (const auto done = read_often(); !done) return fail(done.error());
    judge_round_trips();
    if (ring_ == nullptr)
      if (const auto done = judge_heartbeat(); !done) return fail(done.error());
    judge_bus();
    out_.seconds = seconds_of(session_->now() - begin);
    return std::move(out_);
  }

 private:
  std::string say(std::string_view english) const { return trial::say(*desk_, english); }

  Result<void> read_often() {
    const session::OptionScope once(*session_, &session::Options::retries,
                                    0U);  // A lost answer is to be seen.
    std::uint32_t silent = 0;
    session::Stretch stretch(*session_, kNever);
    for (sent_ = 0; sent_ < test_.count && silent < kGone; ++sent_) {
      stretch.set_share(static_cast<double>(sent_) / test_.count);
      const auto begin = session_->now();
      const auto late = test_.own_delay();
      const auto answer = session_->upload(node_, objects::kDeviceType);
      const auto code = answer ? Errc::negative : answer.error().code;
      if (code == Errc::bus || code == Errc::interrupted) return fail(answer.error());
      const auto own = test_.own_delay() - late;
      const auto took = session_->now() - begin;
      if (code == Errc::timeout && own > took / 2) {
        ++missed_;
        continue;
      }
      silent = code == Errc::timeout ? silent + 1 : 0;
      lost_ += code == Errc::timeout;
      wrong_ += code == Errc::protocol;
      // A refusal is an answer as well.
      if (code != Errc::timeout) add_round_trip(took, own);
    }
    return {};
  }

  void add_round_trip(Duration took, Duration own) {
    const auto taken_off = std::clamp(own, Duration::zero(), took);
    round_trips_.push_back(took - taken_off);
    if (took > test_.longest) most_taken_off_ = std::max(most_taken_off_, taken_off);
  }

  /// How much of the times was this computer's; empty where that changes nothing.
  std::string own_note() const {
    if (most_taken_off_ == Duration::zero()) return {};
    const auto ms = milliseconds_of(most_taken_off_);
    return say(formatted("without up to {:.0f} ms for which this computer was busy", ms));
  }

  void judge_round_trips() {
    if (missed_ > 0 && missed_ == sent_) {
      out_.criteria.push_back(
          report::skipped("lost_answers", say("lost answers"), say("this computer was too busy")));
      return out_.figures.push_back(round_trip_figure(*desk_, {}));
    }
    auto lost = report::at_most("lost_answers", say("lost answers"), lost_, 0);
    const auto judged = sent_ - missed_;
    lost.note = say(formatted("in {} reads", judged));
    if (missed_ > 0)
      lost.note += say(formatted("; {} more were not judged: this computer was busy", missed_));
    if (sent_ < test_.count) lost.note += say(", then given up");
    out_.criteria.push_back(std::move(lost));
    out_.criteria.push_back(report::at_most("wrong_answers", say("protocol violations"), wrong_, 0));
    if (round_trips_.empty()) return out_.figures.push_back(round_trip_figure(*desk_, {}));
    std::sort(round_trips_.begin(), round_trips_.end());
    const auto at = [&](double part) {
      const auto last = static_cast<double>(round_trips_.size() - 1);
      return milliseconds_of(round_trips_[static_cast<std::size_t>(part * last + 0.5)]);
    };
    auto longest = report::at_most("longest_round_trip", say("longest round trip"), at(1),
                                   milliseconds_of(test_.longest), "ms");
    longest.note = own_note();
    out_.criteria.push_back(std::move(longest));
    out_.figures.push_back(round_trip_figure(*desk_, Record{{"reads", round_trips_.size()},
                                                            {"min", at(0)},
                                                            {"median", at(0.5)},
                                                            {"p95", at(0.95)},
                                                            {"max", at(1)}}));
  }

  Result<void> judge_heartbeat() {
    const auto name = say("heartbeat");
    if (session_->gateway() != nullptr) {
      out_.criteria.push_back(report::skipped("heartbeat", name, say("a gateway passes nothing on unasked")));
      return {};
    }
    const auto period = session_->upload(node_, objects::kProducerHeartbeat);
    if (!period && period.error().code != Errc::sdo_abort && period.error().code != Errc::timeout)
      return fail(period.error());
    const auto milliseconds = period ? load_le(*period) & 0xFFFFU : 0;
    if (milliseconds == 0) {
      out_.criteria.push_back(
          report::skipped("heartbeat", name,
                          !period ? say("0x1017 cannot be read") : say("the drive sends none: 0x1017 is 0")));
      return {};
    }
    return measure_heartbeat(name, std::chrono::milliseconds(milliseconds));
  }

  Result<void> measure_heartbeat(const std::string& name, Duration period) {
    const auto& watch = session_->watch();
    const auto patience = std::max<Duration>(3 * period, std::chrono::milliseconds(100));
    std::vector<TimePoint> heard;
    std::vector<Duration> own;  // In the wait for each.
    session::Stretch stretch(*session_, kNever);
    while (heard.size() < kHeartbeats) {
      const auto before = watch.heartbeats(node_);
      const auto late = test_.own_delay();
      const auto waited =
          session_->wait([&] { return watch.heartbeats(node_) > before; }, session_->now() + patience);
      if (!waited) return fail(waited.error());
      if (!*waited) break;
      heard.push_back(session_->now());
      stretch.set_share(static_cast<double>(heard.size()) / kHeartbeats);
      own.push_back(test_.own_delay() - late);
    }
    Duration worst{};
    for (std::size_t i = 1; i < heard.size(); ++i) {
      const auto off = heard[i] - heard[i - 1] - period;
      worst = std::max(worst, (off < Duration::zero() ? -off : off) - own[i] - own[i - 1]);
    }
    auto present = report::at_least("heartbeat", name, static_cast<double>(heard.size()), kHeartbeats);
    present.note = formatted("0x1017: {}", to_string(period));
    out_.criteria.push_back(std::move(present));
    if (heard.size() < 2) return {};
    const auto allowed = std::max<Duration>(
        std::chrono::duration_cast<Duration>(period * kHeartbeatTolerance), kLeastTolerance);
    out_.criteria.push_back(report::at_most("heartbeat_period", say("heartbeat period error"),
                                            milliseconds_of(worst), milliseconds_of(allowed), "ms"));
    return {};
  }

  void judge_bus() {
    take_notices();
    if (session_->gateway() != nullptr) return skip_unasked();
    out_.criteria.push_back(report::at_most("emergencies", say("emergency messages"), emergencies_, 0));
    out_.criteria.push_back(report::at_most("restarts", say("restarts of the drive"),
                                            session_->watch().boots(node_) - boots_, 0));
    if (ring_ != nullptr) return judge_frames();
    out_.criteria.push_back(
        report::at_most("controller_reports", say("error reports of the CAN controller"), reports_, 0));
    judge_controller();
  }

  void skip_unasked() {
    const auto why = say("a gateway passes nothing on unasked");
    out_.criteria.push_back(report::skipped("emergencies", say("emergency messages"), why));
    out_.criteria.push_back(report::skipped("restarts", say("restarts of the drive"), why));
    out_.criteria.push_back(
        report::skipped("controller_reports", say("error reports of the CAN controller"), why));
    judge_controller();
  }

  void judge_frames() {
    const auto& counted = ring_->statistics();
    auto lost = report::at_most("lost_frames", say("lost frames"),
                                static_cast<double>(counted.lost - frames_lost_), 0);
    lost.note = say("a frame goes through all slaves");
    out_.criteria.push_back(std::move(lost));
  }

  void judge_controller() {
    auto name = say("state of the CAN controller");
    const auto link = session::link_of(session_->url());
    if (!link || !link->health) {
      out_.criteria.push_back(
          report::skipped("controller", std::move(name), say("not available on this bus")));
      return;
    }
    const auto wanted = can::LinkHealth::error_active;
    out_.criteria.push_back(report::holds("controller", std::move(name), *link->health == wanted,
                                          std::string(can::name(*link->health)),
                                          std::string(can::name(wanted))));
    if (!link->tx_errors || !link->rx_errors) return;
    out_.criteria.push_back(report::at_most("error_counters", say("error counters of the CAN controller"),
                                            std::max(*link->tx_errors, *link->rx_errors), kMostErrors));
  }

  /// What was heard is counted, and told as it would be without the test.
  void take_notices() {
    auto* network = session_->can();
    for (const auto report :
         network == nullptr ? std::vector<can::ControllerReport>() : network->take_reports()) {
      reports_ += report != can::ControllerReport::error_active;
      desk_->notices.push_back(message("{}: {}", as_it_is(session_->url()), can::text(report)));
    }
    for (const auto& event : session_->take_events()) {
      const auto* emergency = std::get_if<canopen::Emergency>(&event.what);
      if (event.node == node_ && emergency != nullptr && !emergency->is_reset()) emergencies_ += event.times;
      desk_->notices.push_back(
          show::notice_text(event, desk_->profile, desk_->chinese, &desk_->session->network()));
    }
  }

  show::Desk* desk_;
  session::Session* session_;
  session::EtherCatNetwork* ring_ = nullptr;
  std::uint64_t frames_lost_ = 0;  ///< Before the test.
  std::uint8_t node_;
  CommTrial test_;
  TestResult out_;
  std::vector<Duration> round_trips_;
  std::uint32_t sent_ = 0;
  std::uint32_t lost_ = 0;
  std::uint32_t wrong_ = 0;
  std::uint32_t missed_ = 0;  ///< Not answered while this computer was busy.
  Duration most_taken_off_{};
  std::uint32_t emergencies_ = 0;
  std::uint32_t reports_ = 0;
  std::uint32_t boots_ = 0;
};

}  // namespace

Result<TestResult> test_communication(show::Desk& desk, std::uint8_t node, const CommTrial& test) {
  return Communication(desk, node, test).run();
}

}  // namespace servoctl::trial
