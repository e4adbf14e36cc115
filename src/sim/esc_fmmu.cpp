#include "sim/esc_fmmu.hpp"

#include <algorithm>

#include "ethercat/registers.hpp"

namespace servoctl::sim {
namespace reg = ethercat::reg;

EscFmmu EscFmmu::load(const EscMemory& memory, unsigned number) {
  const auto base = reg::fmmu(number);
  const auto byte = [&](unsigned offset) { return memory[static_cast<std::uint16_t>(base + offset)]; };
  const std::uint64_t length = memory.word(static_cast<std::uint16_t>(base + 4));
  const std::uint64_t start_bit = byte(6) & 7U;
  const std::uint64_t end_bit = byte(7) & 7U;
  EscFmmu out;
  out.first_bit = std::uint64_t{memory.dword(base)} * 8 + start_bit;
  const auto end = std::uint64_t{memory.dword(base)} * 8 + (length - 1) * 8 + end_bit + 1;
  out.bits = length != 0 && end > out.first_bit ? end - out.first_bit : 0;
  out.memory_bit = std::uint64_t{memory.word(static_cast<std::uint16_t>(base + 8))} * 8 + (byte(10) & 7U);
  out.reads = (byte(11) & reg::kFmmuReads) != 0;
  out.writes = (byte(11) & reg::kFmmuWrites) != 0;
  out.active = (byte(12) & 1U) != 0;
  return out;
}

std::optional<EscFmmu::Overlap> EscFmmu::overlap(std::uint32_t logical, std::size_t size) const {
  const auto begin = std::uint64_t{logical} * 8;
  const auto from = std::max(begin, first_bit);
  const auto to = std::min(begin + size * 8, first_bit + bits);
  if (!active || from >= to) return std::nullopt;
  const auto memory = memory_bit + (from - first_bit);
  if (memory + (to - from) > EscMemory::kSize * 8) return std::nullopt;
  return Overlap{static_cast<std::size_t>(from - begin), memory, static_cast<std::size_t>(to - from)};
}

}  // namespace servoctl::sim
