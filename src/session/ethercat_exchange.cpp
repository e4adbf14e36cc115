#include "session/ethercat_exchange.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "ethercat/registers.hpp"
#include "ethercat/sii_reader.hpp"
#include "ethercat/sm_watchdog.hpp"
#include "ethercat/words.hpp"
#include "session/ethercat_object_channel.hpp"

namespace servoctl::session {
namespace {

namespace reg = ethercat::reg;
using ethercat::AlState;

constexpr Duration kTimeout = std::chrono::milliseconds(500);
/// Whole cycles that a slave has to have seen before it is asked for OP.
constexpr unsigned kFirstCycles = 5;
constexpr Duration kFirstPatience = std::chrono::milliseconds(400);

}  // namespace

Result<Bytes> EtherCatExchange::upload(ObjectAddress object) {
  EtherCatObjectChannel channel(*network_, *node_, kTimeout);
  channel.start_upload(object, network_->now(), canopen::Transfer::automatic, 0);
  return channel.finish_transfer();
}

Result<void> EtherCatExchange::download(ObjectAddress object, Bytes data) {
  EtherCatObjectChannel channel(*network_, *node_, kTimeout);
  channel.start_download(object, std::move(data), network_->now(), canopen::Transfer::automatic);
  const auto done = channel.finish_transfer();
  if (!done) return fail(done.error());
  return {};
}

Result<void> EtherCatExchange::begin(AlState target) {
  if (const auto ready = network_->prepare(*node_); !ready) return ready;
  if (node_->exchanges() && node_->al && node_->al->state == target && !node_->al->error) return {};
  if (node_->raised)
    if (const auto down = end(); !down) return down;
  auto done = climb(target);
  // Free run first: a pulse has to be kept, and most drives need none for what is done here.
  if (!done && done.error().code == Errc::negative && has_clock_ && node_->al &&
      ethercat::demands_clock(node_->al->code)) {
    const auto why =
        message("{} (AL status code {:04X}h)", ethercat::al_status_text(node_->al->code), node_->al->code);
    synchronous_ = true;
    done = end();
    if (done) done = climb(target);
    if (done)
      network_->notices_.push_back(
          message("node {}: it runs with SYNC0 every 4 ms, because it refused without: {}",
                  node_name(node_->number), why));
  }
  if (!done) {
    auto error = done.error();
    if (const auto back = end(); !back) error.message += "; and then: " + back.error().message;
    return fail(std::move(error));
  }
  return {};
}

Result<void> EtherCatExchange::climb(AlState target) {
  network_->set_raised(*node_, true);
  if (const auto there = network_->go_to(*node_, AlState::preop); !there) return fail(there.error());
  network_->set_raised(*node_, true);
  const auto mapped = mapping();
  if (!mapped) return fail(mapped.error());
  const auto values = presets(mapped->outputs);
  if (!values) return fail(values.error());
  const auto place = area();
  if (!place) return fail(place.error());
  const auto lrw = knows_lrw();
  if (!lrw) return fail(lrw.error());
  auto image = std::make_unique<ethercat::ProcessImage>(
      ethercat::ProcessImage::Options{.logical = std::uint32_t{node_->number} << 16U});
  const auto logical = image->add(node_->number, *mapped, *lrw);
  const auto plan = plan_slave(node_->number, *place, *mapped, logical);
  if (!plan) return fail(plan.error());
  if (const auto set = set_up(*plan); !set) return set;
  if (synchronous_)
    if (const auto set = start_clock(image->options().cycle); !set) return set;
  if (const auto there = network_->go_to(*node_, AlState::safeop); !there) return fail(there.error());
  for (const auto& preset : *values)
    if (const auto set = image->set(node_->number, preset.object, preset.value); !set)
      return fail(set.error());
  if (const auto started = image->start(network_->now()); !started) return started;
  node_->image = std::move(image);
  if (const auto flows = flow(); !flows) return flows;
  if (target == AlState::safeop) return {};
  if (const auto there = network_->go_to(*node_, AlState::op); !there) return fail(there.error());
  return {};
}

Result<ethercat::ProcessArea> EtherCatExchange::area() {
  ethercat::SiiReader reader(node_->number, node_->address());
  reader.start(network_->now());
  const auto image = network_->wire_.ask(reader);
  if (!image && (image.error().code == Errc::bus || image.error().code == Errc::interrupted))
    return fail(image.error());
  if (image)
    if (const auto out = ethercat::process_area(ethercat::parse_sii(*image)); out.exists()) return out;
  ethercat::ProcessArea out;
  out.out_start = node_->rules.outputs;
  out.in_start = node_->rules.inputs;
  out.out_control = reg::kSmOutputs;
  out.in_control = reg::kSmInputs;
  return out;
}

Result<bool> EtherCatExchange::knows_lrw() {
  const auto replies = network_->wire_.exchange({read_registers(node_->address(), reg::kFmmuCount, 1),
                                                 read_registers(node_->address(), reg::kFeatures, 2)});
  if (!replies) return fail(replies.error());
  if (!(*replies)[0].done() || !(*replies)[1].done()) return fail(network_->no_answer(node_->number));
  fmmus_ = (*replies)[0].data[0];
  const auto features = ethercat::word_at((*replies)[1].data, 0);
  has_clock_ = (features & reg::kFeatureDc) != 0;
  clock_bits_ = (features & reg::kFeatureDc64) != 0 ? 64 : 32;
  return (features & reg::kFeatureNoLrw) == 0;
}

Result<void> EtherCatExchange::write_all(const std::vector<ethercat::Request>& requests) {
  const auto replies = network_->wire_.exchange(requests);
  if (!replies) return fail(replies.error());
  for (std::size_t i = 0; i < requests.size(); ++i)
    if (!(*replies)[i].done())
      return fail(drive_error(Errc::timeout, node_->number,
                              message("register {:04X}h was not written", requests[i].address >> 16U),
                              network_->silence_hint(node_->number)));
  return {};
}

/// What a predecessor left in FMMUs and clocks is taken away first.
Result<void> EtherCatExchange::set_up(const ethercat::SlavePlan& plan) {
  const auto slave = node_->address();
  constexpr unsigned kMostFmmus = 16;
  std::vector<ethercat::Request> requests;
  const auto fmmus = std::min(fmmus_, kMostFmmus);
  if (fmmus > 0) requests.push_back(write_registers(slave, reg::fmmu(0), Bytes(fmmus * reg::kFmmuSize, 0)));
  if (has_clock_) requests.push_back(write_registers(slave, reg::kDcActivation, {0}));
  const auto watchdog = ethercat::sm_watchdog(node_->watchdog);
  if (!watchdog) return fail(watchdog.error());
  for (auto& request : watchdog->requests(slave)) requests.push_back(std::move(request));
  for (auto& request : plan.requests(slave)) requests.push_back(std::move(request));
  return write_all(requests);
}

/// Outputs have to come before OP is asked for (AL status code 001Bh else), and inputs have to be there
/// before anybody reads one.
Result<void> EtherCatExchange::flow() {
  const auto end = network_->now() + kFirstPatience;
  const auto& cycle = node_->image->options().cycle;
  for (;;) {
    if (const auto stepped = network_->wire_.step(network_->now() + cycle); !stepped)
      return fail(stepped.error());
    if (!node_->exchanges()) break;
    const auto& counts = node_->image->counts(node_->number);
    const bool in_step = !node_->clock || node_->clock->is_locked();
    if (counts.cycles >= kFirstCycles && counts.missing == 0 && in_step) return {};
    if (network_->now() < end) continue;
    if (counts.missing == 0)
      return fail(drive_error(Errc::timeout, node_->number,
                              "its cycles cannot be kept in step with its clock",
                              "is this machine too busy? A load beside servoctl delays its frames"));
    return fail(drive_error(Errc::timeout, node_->number,
                            message("its process data are not complete: {}", cycle_trouble(counts)),
                            network_->silence_hint(node_->number)));
  }
  return fail(drive_error(Errc::timeout, node_->number, "process data ended before they began",
                          network_->silence_hint(node_->number)));
}

Result<void> EtherCatExchange::start_clock(Duration cycle) {
  auto& clock = node_->clock.emplace(node_->address(), cycle, clock_bits_);
  const auto time = network_->wire_.exchange({clock.ask_time()});
  if (!time) return fail(time.error());
  if (!time->front().done()) return fail(network_->no_answer(node_->number));
  return write_all(clock.start(load_le(time->front().data)));
}

Result<void> EtherCatExchange::put_assignment_back() {
  Result<void> out;
  for (const auto& before : std::exchange(node_->assigned, {}))
    if (auto done = assign(before); !done && out) out = done;
  return out;
}

Result<void> EtherCatExchange::end() {
  if (node_->exchanges() && node_->al && node_->al->state == AlState::op)
    (void)network_->go_to(*node_, AlState::safeop);  // What refuses is asked for PRE-OP all the same.
  const auto clock = std::exchange(node_->clock, std::nullopt);
  network_->end_cycles(*node_);
  const auto there = network_->go_to(*node_, AlState::preop);
  if (!there) return fail(there.error());
  network_->set_raised(*node_, false);
  if (clock)
    if (const auto off = write_all({clock->stop()}); !off) return off;
  return put_assignment_back();
}

}  // namespace servoctl::session
