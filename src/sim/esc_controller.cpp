#include "sim/esc_controller.hpp"

#include <algorithm>

#include "sim/esc_bits.hpp"

namespace servoctl::sim {
using ethercat::Command;
using ethercat::Datagram;

namespace {

constexpr unsigned kReadWeight = 1;
/// Of a command that reads as well (ETG.1000.4, table of working counters).
constexpr unsigned kReadWriteWeight = 2;

/// Every slave that such a datagram passes adds 1 to its position.
bool counts_positions(Command command) {
  switch (command) {
    case Command::aprd:
    case Command::apwr:
    case Command::aprw:
    case Command::armw:
    case Command::brd:
    case Command::bwr:
    case Command::brw: return true;
    default: return false;
  }
}

}  // namespace

EscController::Access EscController::access_of(const Datagram& datagram) const {
  const bool here = datagram.adp() == 0;
  const bool mine = registers_.answers_to(datagram.adp());
  switch (datagram.command) {
    case Command::aprd: return {here, false};
    case Command::apwr: return {false, here};
    case Command::aprw: return {here, here, false, kReadWriteWeight};
    case Command::fprd: return {mine, false};
    case Command::fpwr: return {false, mine};
    case Command::fprw: return {mine, mine, false, kReadWriteWeight};
    case Command::brd: return {true, false, true};
    case Command::bwr: return {false, true};
    case Command::brw: return {true, true, true, kReadWriteWeight};
    case Command::armw: return {here, !here};
    case Command::frmw: return {mine, !mine};
    default: return {};
  }
}

bool EscController::process(std::span<std::uint8_t> frame, TimePoint now) {
  registers_.begin_frame(now);
  auto reader = ethercat::FrameReader::open(frame);
  if (!reader) {
    registers_.count_malformed();
    return false;
  }
  constexpr std::size_t kSource = 6;
  frame[kSource] |= 0x02;  // That it went through a slave shows in the address it came from.
  while (const auto datagram = reader->next()) {
    const auto data = data_of(frame, *datagram);
    const auto done = is_logical(datagram->command)
                          ? access_logical(datagram->address, datagram->command, data)
                          : access_memory(datagram->ado(), access_of(*datagram), data);
    set_working_counter(frame, *datagram, static_cast<std::uint16_t>(datagram->working_counter + done));
    if (counts_positions(datagram->command))
      set_address(
          frame, *datagram,
          ethercat::physical_address(static_cast<std::uint16_t>(datagram->adp() + 1), datagram->ado()));
    registers_.finish_datagram(now);
  }
  return true;
}

unsigned EscController::access_memory(std::uint32_t address, Access access, std::span<std::uint8_t> data) {
  unsigned done = 0;
  const Bytes sent(data.begin(), data.end());
  if (access.reads) {
    auto found = access.merges ? Bytes(data.size(), 0) : sent;
    if (registers_.read(address, found)) done += kReadWeight;
    for (std::size_t i = 0; i < data.size(); ++i)
      data[i] = static_cast<std::uint8_t>(access.merges ? data[i] | found[i] : found[i]);
  }
  if (access.writes && registers_.write(address, sent)) done += access.write_weight;
  return done;
}

unsigned EscController::access_logical(std::uint32_t address, Command command, std::span<std::uint8_t> data) {
  bool read = false;
  bool written = false;
  const Bytes sent(data.begin(), data.end());
  // What is read is what stood there before the datagram.
  for (const bool now_writes : {false, true})
    for (unsigned i = 0; i < EscRegisters::kFmmus; ++i) {
      const auto fmmu = EscFmmu::load(registers_.memory(), i);
      const auto bits = fmmu.overlap(address, data.size());
      if (!bits) continue;
      if (now_writes && fmmu.writes && writes(command)) written = write_bits(*bits, sent) || written;
      if (!now_writes && fmmu.reads && reads(command)) read = read_bits(*bits, data) || read;
    }
  const auto write_weight = command == Command::lrw ? kReadWriteWeight : 1U;
  return (read ? kReadWeight : 0U) + (written ? write_weight : 0U);
}

bool EscController::read_bits(const EscFmmu::Overlap& bits, std::span<std::uint8_t> data) {
  const auto first = bits.memory_bit / 8;
  const auto behind = (bits.memory_bit + bits.count + 7) / 8;
  Bytes found(behind - first, 0);
  if (!registers_.read(static_cast<std::uint32_t>(first), found)) return false;
  copy_bits(data, bits.data_bit, found, bits.memory_bit % 8, bits.count);
  return true;
}

bool EscController::write_bits(const EscFmmu::Overlap& bits, ByteSpan data) {
  const auto first = bits.memory_bit / 8;
  const auto behind = (bits.memory_bit + bits.count + 7) / 8;
  Bytes image(behind - first, 0);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = registers_.peek(static_cast<std::uint32_t>(first + i));
  copy_bits(image, bits.memory_bit % 8, data, bits.data_bit, bits.count);
  return registers_.write(static_cast<std::uint32_t>(first), image);
}

}  // namespace servoctl::sim
