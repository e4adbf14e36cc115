#include "session/object_survey.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/addressing.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {
namespace {

/// Few enough that little is asked after an alarm, and that silence costs little.
constexpr std::size_t kAtOnce = 16;

bool is_of_one_object(const Error& error) {
  return error.code == Errc::sdo_abort || error.code == Errc::protocol;
}

}  // namespace

Result<std::vector<Result<Bytes>>> ObjectSurvey::read(std::span<const ObjectAddress> objects) {
  std::vector<Result<Bytes>> out;
  while (out.size() < objects.size()) {
    const auto part = objects.subspan(out.size(), std::min(kAtOnce, objects.size() - out.size()));
    auto answers = ask(part);
    if (const auto taken = take(answers, part, out); !taken) return fail(taken.error());
    if (const auto quiet = check_alarms(part.back()); !quiet) return fail(quiet.error());
  }
  return out;
}

Result<bool> ObjectSurvey::is_enabled() { return is_any_axis_energised(*session_, node_); }

std::vector<Result<Bytes>> ObjectSurvey::ask(std::span<const ObjectAddress> objects) {
  std::vector<SdoRequest> requests;
  for (const auto object : objects)
    requests.push_back({.node = node_, .object = object, .despite_alarm = despite_alarms_});
  return longest_ == kNoLimit ? session_->transfer(requests) : transfer_limited(requests);
}

/// The session has no limit of its own: what is too long is ended as by an interruption.
std::vector<Result<Bytes>> ObjectSurvey::transfer_limited(std::span<const SdoRequest> requests) {
  is_too_long_ = false;
  const auto progress = session_->options().progress;
  const auto cancelled = session_->options().cancelled;
  using Progress = decltype(Options::progress);
  const OptionScope counts(*session_, &Options::progress,
                           Progress([&](std::size_t done, std::optional<std::size_t> total, TimePoint now) {
                             is_too_long_ = is_too_long_ || std::max(done, total.value_or(0)) > longest_;
                             if (progress) progress(done, total, now);
                           }));
  const OptionScope ends(*session_, &Options::cancelled,
                         std::function<bool()>([&] { return is_too_long_ || (cancelled && cancelled()); }));
  return session_->transfer(requests);
}

/// What follows a read without an answer, or one that was given up, was not sent: it is asked for again if
/// the node still answers, and so is what came late.
Result<void> ObjectSurvey::take(std::vector<Result<Bytes>>& answers, std::span<const ObjectAddress> objects,
                                std::vector<Result<Bytes>>& out) {
  for (std::size_t i = 0; i < answers.size(); ++i) {
    auto& answer = answers[i];
    const bool is_silent = !answer && answer.error().code == Errc::timeout;
    if (is_silent) {
      if (const auto alive = check_alive(answer.error()); !alive) return alive;
      answer = std::move(ask(objects.subspan(i, 1)).front());
    }
    const bool is_given_up = !answer && answer.error().code == Errc::interrupted && is_too_long_;
    if (is_given_up) {
      // The read of 1000h ends what the node still sends of the other.
      if (const auto alive = check_alive(answer.error()); !alive) return alive;
      answer = fail(drive_error(Errc::protocol, node_, objects[i],
                                message("it sends more than {} bytes for this object", longest_)));
    }
    if (!answer && !is_of_one_object(answer.error()) && answer.error().code != Errc::timeout)
      return fail(answer.error());
    out.push_back(std::move(answer));
    if (is_silent || is_given_up) return {};
  }
  return {};
}

Result<void> ObjectSurvey::check_alive(const Error& silence) {
  const auto type = session_->upload(node_, objects::kDeviceType);
  if (type || type.error().code == Errc::sdo_abort) return {};
  return fail(type.error().code == Errc::timeout ? silence : type.error());
}

Result<void> ObjectSurvey::check_alarms(ObjectAddress last) {
  const auto before = std::exchange(heard_, session_->watch().alarms(node_));
  if (heard_ == before || despite_alarms_) return {};
  const auto& known = session_->watch().emergencies(node_);
  const auto what = known.empty() ? std::string("an EMCY") : formatted("the EMCY {:04X}h", known.back().code);
  return fail(drive_error(
      Errc::refused, node_,
      message("it sent {} during the reads up to {}; nothing more is read", what, to_string(last)),
      "`status` and `fault show` tell whether the drive is in a fault"));
}

}  // namespace servoctl::session
