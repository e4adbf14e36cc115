#include "session/ethercat_object_channel.hpp"

#include "base/format.hpp"

namespace servoctl::session {
namespace {

/// Cycles in succession without an exact working counter after which nothing more is waited for. Process data
/// that do not flow end every wait for them within 40 ms, before the watchdog of a drive (100 ms) does.
constexpr unsigned kMostMissing = 10;

}  // namespace

std::string cycle_trouble(const ethercat::ProcessImage::Counts& counts) {
  if (counts.missing == 0) return "no cycle was made in time";
  if (counts.expected == 0) return "frames do not come back";
  return formatted("working counter {} instead of {}", counts.counter, counts.expected);
}

EtherCatObjectChannel::~EtherCatObjectChannel() {
  if (node_->owner == this) node_->owner = nullptr;
}

void EtherCatObjectChannel::begin(ObjectAddress object, TimePoint now, canopen::Transfer transfer) {
  object_ = object;
  transfer_ = transfer;
  way_ = Way::waiting;
  until_ = now + timeout_;
  result_.reset();
  stirred_ = true;
}

void EtherCatObjectChannel::start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                                         std::size_t) {
  begin(object, now, transfer);
  data_.reset();
}

void EtherCatObjectChannel::start_download(ObjectAddress object, Bytes data, TimePoint now,
                                           canopen::Transfer transfer) {
  begin(object, now, transfer);
  data_ = std::move(data);
}

Result<void> EtherCatObjectChannel::on_time(TimePoint now) {
  // Everything else was served by the last step.
  if (way_ == Way::waiting)
    if (const auto went = set_out(); !went) return went;
  if (way_ == Way::output || way_ == Way::input) serve_image(now);
  // What the mailbox brings is told by stir(); anything else may be there after each step.
  stirred_ = way_ != Way::mailbox || result_;
  return {};
}

/// Errors of the node are the transfer's, those of the network are everybody's.
Result<void> EtherCatObjectChannel::set_out() {
  if (!node_->coe) {
    const auto ready = network_->prepare(*node_);
    if (!ready && (ready.error().code == Errc::bus || ready.error().code == Errc::interrupted)) return ready;
    if (!ready) {
      finish(fail(ready.error()));
      return {};
    }
    until_ = network_->now() + timeout_;
  }
  const auto now = network_->now();
  // One transfer at a time; whoever is before has its own limit.
  if (!start_image() && !node_->coe->client().busy()) start_mailbox(now);
  return network_->wire_.flush(now);
}

void EtherCatObjectChannel::start_mailbox(TimePoint now) {
  auto& client = node_->coe->client();
  (void)client.take_result();
  node_->owner = this;
  way_ = Way::mailbox;
  client.set_timeout(timeout_);
  const bool again = std::exchange(again_, false);
  if (data_)
    client.start_download(object_, std::move(*data_), now, transfer_);
  else
    client.start_upload(object_, now, transfer_, false, again);
}

bool EtherCatObjectChannel::start_image() {
  if (!node_->exchanges()) return false;
  auto& image = *node_->image;
  if (data_) {
    if (!image.output_bits(node_->number, object_)) return false;
    const auto cycle = image.set(node_->number, object_, *data_);
    if (!cycle) {
      finish(fail(cycle.error()));
      return true;
    }
    cycle_ = *cycle;
    way_ = Way::output;
    return true;
  }
  const auto bits = image.input_bits(node_->number, object_);
  if (!bits || *bits % 8 != 0) return false;
  fetched_after_ = node_->output_at;
  way_ = Way::input;
  return true;
}

void EtherCatObjectChannel::serve_image(TimePoint now) {
  if (!node_->exchanges()) {
    const auto why = node_->al && node_->al->error ? ethercat::al_status_text(node_->al->code)
                                                   : std::string("`status` shows its state");
    const auto* what = way_ == Way::output ? "process data ended, so whether it was written is not known"
                                           : "process data ended before it was read";
    return finish(fail(drive_error(Errc::timeout, node_->number, object_, what, why)));
  }
  const auto& image = *node_->image;
  if (way_ == Way::output && image.is_written(node_->number, cycle_)) {
    node_->output_at = now;
    return finish(Bytes{});
  }
  if (way_ == Way::input) {
    const auto input = image.fresh_input(node_->number, object_, now);
    if (input && input->time >= fetched_after_) return finish(input->value);
  }
  const auto& counts = image.counts(node_->number);
  if (now < until_ && counts.missing < kMostMissing) return;
  const auto* what = way_ == Way::output ? "whether it was written is not known" : "its inputs did not come";
  finish(
      fail(drive_error(Errc::timeout, node_->number, object_, message("{}: {}", what, cycle_trouble(counts)),
                       network_->silence_hint(node_->number))));
}

void EtherCatObjectChannel::finish(Result<Bytes> result) {
  if (!result) {
    result.error().node = node_->number;
    result.error().object = object_;
  }
  result_ = std::move(result);
  stirred_ = true;
}

std::optional<Result<Bytes>> EtherCatObjectChannel::take_result() {
  if (!result_ && way_ == Way::mailbox && node_->owner == this && node_->coe)
    result_ = node_->coe->client().take_result();
  if (!result_) return std::nullopt;
  if (node_->owner == this) node_->owner = nullptr;
  way_ = Way::none;
  return std::exchange(result_, std::nullopt);
}

bool EtherCatObjectChannel::busy() const {
  if (way_ == Way::none || result_) return false;
  return way_ != Way::mailbox || (node_->coe && node_->owner == this && node_->coe->client().busy());
}

TimePoint EtherCatObjectChannel::deadline() const {
  switch (way_) {
    case Way::none: return kNever;
    // Somebody else's transfer ends with a frame, or by its limit.
    case Way::waiting: return node_->coe ? node_->coe->client().deadline() : TimePoint::min();
    case Way::mailbox: return node_->coe ? node_->coe->client().deadline() : TimePoint::min();
    case Way::output:
    case Way::input: return until_;
  }
  return kNever;
}

std::size_t EtherCatObjectChannel::transferred() const {
  return way_ == Way::mailbox && node_->coe ? node_->coe->client().transferred() : 0;
}

std::optional<std::size_t> EtherCatObjectChannel::total() const {
  return way_ == Way::mailbox && node_->coe ? node_->coe->client().total() : std::nullopt;
}

Result<Bytes> EtherCatObjectChannel::finish_transfer() {
  for (;;) {
    if (const auto went = on_time(network_->now()); !went) return fail(went.error());
    if (auto result = take_result()) return std::move(*result);
    if (const auto stepped = network_->wire_.step(deadline()); !stepped) return fail(stepped.error());
  }
}

void EtherCatObjectChannel::on_lost(const Error& why) {
  if (way_ == Way::mailbox && !result_) finish(fail(why));
}

}  // namespace servoctl::session
