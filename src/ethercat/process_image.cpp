#include "ethercat/process_image.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "ethercat/bit_field.hpp"

namespace servoctl::ethercat {
namespace {

template <class Fields>
auto* field_of(Fields& fields, ObjectAddress object) {
  const auto place =
      std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.object == object; });
  return place == fields.end() ? nullptr : &*place;
}

std::size_t bytes_for(std::size_t bits) { return (bits + 7) / 8; }

/// LRW counts 2 for what was written and 1 for what was read; apart each counts 1 (ETG.1000.4, 5.4).
constexpr std::uint16_t kTaken = 2;
constexpr std::uint16_t kGiven = 1;

std::uint16_t expected_counter(Command command, bool outputs, bool inputs) {
  if (command != Command::lrw) return 1;
  return static_cast<std::uint16_t>((outputs ? kTaken : 0U) + (inputs ? kGiven : 0U));
}

}  // namespace

ProcessImage::ProcessImage(const Options& options) : options_(options), end_(options.logical) {
  options_.patience = std::clamp(options_.patience, 1U, kMaxPatience);
}

std::uint32_t ProcessImage::add(std::uint8_t node, const ProcessMapping& mapping, bool lrw) {
  const auto fields = [](const std::vector<canopen::PdoEntry>& entries) {
    std::vector<Field> out;
    std::size_t at = 0;
    for (const auto& entry : entries) {
      if (!entry.is_gap()) out.push_back({entry.object, at, entry.bits, false});
      at += entry.bits;
    }
    return out;
  };
  Slave slave;
  slave.node = node;
  slave.lrw = lrw;
  slave.logical = end_;
  slave.out_fields = fields(mapping.outputs);
  slave.in_fields = fields(mapping.inputs);
  slave.outputs.resize(bytes_of(mapping.outputs));
  slave.inputs.resize(bytes_of(mapping.inputs));
  end_ += static_cast<std::uint32_t>(slave.outputs.size() + slave.inputs.size());
  slaves_.push_back(std::move(slave));
  return slaves_.back().logical;
}

const ProcessImage::Slave* ProcessImage::find(std::uint8_t node) const {
  const auto place =
      std::find_if(slaves_.begin(), slaves_.end(), [&](const Slave& s) { return s.node == node; });
  return place == slaves_.end() ? nullptr : &*place;
}

ProcessImage::Slave* ProcessImage::find(std::uint8_t node) {
  const auto place =
      std::find_if(slaves_.begin(), slaves_.end(), [&](const Slave& s) { return s.node == node; });
  return place == slaves_.end() ? nullptr : &*place;
}

std::optional<std::size_t> ProcessImage::output_bits(std::uint8_t node, ObjectAddress object) const {
  const auto* slave = find(node);
  const auto* field = slave != nullptr ? field_of(slave->out_fields, object) : nullptr;
  return field != nullptr ? std::optional(field->bits) : std::nullopt;
}

std::optional<std::size_t> ProcessImage::input_bits(std::uint8_t node, ObjectAddress object) const {
  const auto* slave = find(node);
  const auto* field = slave != nullptr ? field_of(slave->in_fields, object) : nullptr;
  return field != nullptr ? std::optional(field->bits) : std::nullopt;
}

Result<ProcessImage::Cycle> ProcessImage::set(std::uint8_t node, ObjectAddress object, ByteSpan value) {
  const auto bits = output_bits(node, object);
  if (!bits)
    return fail(drive_error(Errc::usage, node, object, "it is not among the outputs of the process image",
                            "`pdo show` shows what is mapped"));
  if (value.size() != bytes_for(*bits))
    return fail(drive_error(Errc::usage, node, object,
                            message("{} bytes for an output of {} bits", value.size(), *bits),
                            "the mapping says how long it is: `pdo show`"));
  auto* slave = find(node);
  for (auto& field : slave->out_fields) {
    if (field.object != object) continue;
    write_bits(slave->outputs, field.at, std::min(field.bits, 8 * value.size()), value);
    field.is_set = true;
  }
  return cycle_ + 1;
}

std::optional<Bytes> ProcessImage::output(std::uint8_t node, ObjectAddress object) const {
  const auto* slave = find(node);
  const auto* field = slave != nullptr ? field_of(slave->out_fields, object) : nullptr;
  if (field == nullptr || !field->is_set) return std::nullopt;
  Bytes out(bytes_for(field->bits));
  read_bits(slave->outputs, field->at, field->bits, out);
  return out;
}

bool ProcessImage::is_written(std::uint8_t node, Cycle cycle) const {
  const auto* slave = find(node);
  return slave != nullptr && slave->taken >= cycle;
}

std::optional<ProcessImage::Input> ProcessImage::input(std::uint8_t node, ObjectAddress object) const {
  const auto* slave = find(node);
  const auto* field = slave != nullptr ? field_of(slave->in_fields, object) : nullptr;
  if (field == nullptr || slave->given == 0) return std::nullopt;
  Input out{Bytes(bytes_for(field->bits)), slave->given_at};
  read_bits(slave->inputs, field->at, field->bits, out.value);
  return out;
}

std::optional<ProcessImage::Input> ProcessImage::fresh_input(std::uint8_t node, ObjectAddress object,
                                                             TimePoint now, unsigned cycles) const {
  auto out = input(node, object);
  if (out && now - out->time > options_.cycle * cycles) out.reset();
  return out;
}

std::vector<ObjectAddress> ProcessImage::unset(std::uint8_t node) const {
  std::vector<ObjectAddress> out;
  const auto* slave = find(node);
  if (slave == nullptr) return out;
  for (const auto& field : slave->out_fields)
    if (!field.is_set) out.push_back(field.object);
  return out;
}

Result<void> ProcessImage::start(TimePoint now) {
  for (const auto& slave : slaves_) {
    const auto missing = unset(slave.node);
    if (!missing.empty())
      return fail(drive_error(
          Errc::refused, slave.node, missing.front(),
          "this output was never set, and the drive would obey a zero",
          "outputs are preset from the drive before they are sent; do not map one that cannot be read"));
  }
  next_ = now;
  return {};
}

void ProcessImage::serve(Ring& ring, TimePoint now) {
  for (auto& slave : slaves_) collect(slave, ring);
  if (!running() || now < next_) return;
  rhythm_.latest = std::max(rhythm_.latest, now - next_);
  const auto behind = (now - next_) / options_.cycle;
  rhythm_.skipped += static_cast<std::uint64_t>(behind);
  next_ += options_.cycle * (behind + 1);
  ++rhythm_.cycles;
  ++cycle_;
  for (auto& slave : slaves_) send(slave, ring);
}

void ProcessImage::send(Slave& slave, Ring& ring) {
  ++slave.counts.cycles;
  if (!slave.lrw) {
    const auto inputs_at = slave.logical + static_cast<std::uint32_t>(slave.outputs.size());
    buffer_.assign(slave.inputs.size(), 0);
    if (!slave.outputs.empty()) post(slave, Command::lwr, slave.logical, slave.outputs, ring);
    if (!buffer_.empty()) post(slave, Command::lrd, inputs_at, buffer_, ring);
    return;
  }
  buffer_.assign(slave.outputs.begin(), slave.outputs.end());
  buffer_.resize(slave.outputs.size() + slave.inputs.size());
  if (!buffer_.empty()) post(slave, Command::lrw, slave.logical, buffer_, ring);
}

void ProcessImage::post(Slave& slave, Command command, std::uint32_t logical, ByteSpan data, Ring& ring) {
  Ring::Post how;
  how.urgent = true;
  how.expected = expected_counter(command, !slave.outputs.empty(), !slave.inputs.empty());
  how.timeout = options_.cycle * options_.patience;
  const auto place =
      std::find_if(slave.flights.begin(), slave.flights.end(), [](const Flight& f) { return !f.open; });
  Flight flight{0, cycle_, command, true};
  const auto ticket = place == slave.flights.end() ? std::nullopt : ring.post(command, logical, data, how);
  if (!ticket) {
    ++slave.counts.lost;
    return count(slave, flight, false);
  }
  flight.ticket = *ticket;
  *place = flight;
}

void ProcessImage::collect(Slave& slave, Ring& ring) {
  for (auto& flight : slave.flights) {
    if (!flight.open) continue;
    const auto answer = ring.take_answer(flight.ticket);
    if (!answer) continue;
    flight.open = false;
    take_in(slave, flight, *answer);
  }
}

void ProcessImage::take_in(Slave& slave, const Flight& flight, const Answer& answer) {
  if (answer.lost) {
    ++slave.counts.lost;
    slave.counts.expected = 0;
    return count(slave, flight, false);
  }
  const bool has_outputs = !slave.outputs.empty() && flight.command != Command::lrd;
  const bool has_inputs = !slave.inputs.empty() && flight.command != Command::lwr;
  const auto expected = expected_counter(flight.command, has_outputs, has_inputs);
  if (answer.working_counter != expected) {
    const bool both = flight.command == Command::lrw;
    if (has_outputs && !(both && answer.working_counter == kTaken)) ++slave.counts.short_outputs;
    if (has_inputs && !(both && answer.working_counter == kGiven)) ++slave.counts.short_inputs;
    slave.counts.counter = answer.working_counter;
    slave.counts.expected = expected;
    return count(slave, flight, false);
  }
  if (has_outputs) slave.taken = std::max(slave.taken, flight.cycle);
  // One that was overtaken brings what is past.
  if (has_inputs && flight.cycle > slave.given) {
    const auto data = answer.data.last(slave.inputs.size());
    std::copy(data.begin(), data.end(), slave.inputs.begin());
    slave.given = flight.cycle;
    slave.given_at = answer.sent;
  }
  count(slave, flight, true);
}

/// A slave that is read and written apart misses a cycle when it misses one half.
void ProcessImage::count(Slave& slave, const Flight& flight, bool whole) {
  if (!whole) {
    ++slave.counts.missing;
  } else if (flight.command == Command::lrw || (slave.taken >= flight.cycle && slave.given >= flight.cycle) ||
             slave.outputs.empty() || slave.inputs.empty()) {
    slave.counts.missing = 0;
  }
}

void ProcessImage::leave(Ring& ring) {
  for (auto& slave : slaves_)
    for (auto& flight : slave.flights)
      if (std::exchange(flight.open, false)) ring.forget(flight.ticket);
}

const ProcessImage::Counts& ProcessImage::counts(std::uint8_t node) const {
  static const Counts kNone;
  const auto* slave = find(node);
  return slave != nullptr ? slave->counts : kNone;
}

}  // namespace servoctl::ethercat
