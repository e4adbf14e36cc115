#include "ethercat/slave_plan.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::size_t kBuffers = 3;

}  // namespace

std::size_t bits_of(std::span<const canopen::PdoEntry> entries) {
  std::size_t out = 0;
  for (const auto& entry : entries) out += entry.bits;
  return out;
}

std::size_t bytes_of(std::span<const canopen::PdoEntry> entries) { return (bits_of(entries) + 7) / 8; }

ProcessArea process_area(const SiiImage& image) {
  ProcessArea out;
  for (std::size_t i = 0; i < image.sync_managers.size() && i < 16; ++i) {
    const auto& row = image.sync_managers[i];
    const auto number = static_cast<std::uint8_t>(i);
    if (row.use == SiiSyncManager::Use::outputs && out.out_start == 0) {
      out.out_manager = number;
      out.out_start = row.start;
      out.out_control = row.control;
    } else if (row.use == SiiSyncManager::Use::inputs && out.in_start == 0) {
      out.in_manager = number;
      out.in_start = row.start;
      out.in_control = row.control;
    }
  }
  return out;
}

Bytes sync_manager_bytes(std::uint16_t start, std::uint16_t length, std::uint8_t control) {
  Bytes out(reg::kSyncManagerSize);
  store_le(start, std::span(out).first(2));
  store_le(length, std::span(out).subspan(2, 2));
  out[4] = control;
  out[6] = length != 0 ? reg::kSmEnable : std::uint8_t{0};
  return out;
}

Bytes fmmu_bytes(std::uint32_t logical, std::uint16_t length, std::uint16_t physical, std::uint8_t type) {
  Bytes out(reg::kFmmuSize);
  if (length == 0) return out;
  store_le(logical, std::span(out).first(4));
  store_le(length, std::span(out).subspan(4, 2));
  out[7] = 7;  // The last bit of the last byte.
  store_le(physical, std::span(out).subspan(8, 2));
  out[11] = type;
  out[12] = 1;
  return out;
}

Request mailbox_setup(SlaveAddress slave, const SiiMailbox& mailbox) {
  auto bytes = sync_manager_bytes(mailbox.out_start, mailbox.out_size, reg::kSmMailboxOut);
  const auto in = sync_manager_bytes(mailbox.in_start, mailbox.in_size, reg::kSmMailboxIn);
  bytes.insert(bytes.end(), in.begin(), in.end());
  return write_registers(slave, reg::sync_manager(0), std::move(bytes));
}

std::vector<Request> SlavePlan::requests(SlaveAddress slave, bool watchdog) const {
  const auto watched = static_cast<std::uint8_t>(watchdog ? area.out_control | reg::kSmControlWatchdog
                                                          : area.out_control & ~reg::kSmControlWatchdog);
  return {
      write_registers(slave, reg::sync_manager(area.out_manager),
                      sync_manager_bytes(area.out_start, out_size, watched)),
      write_registers(slave, reg::sync_manager(area.in_manager),
                      sync_manager_bytes(area.in_start, in_size, area.in_control)),
      write_registers(slave, reg::fmmu(0), fmmu_bytes(logical, out_size, area.out_start, reg::kFmmuWrites)),
      write_registers(slave, reg::fmmu(1),
                      fmmu_bytes(logical + out_size, in_size, area.in_start, reg::kFmmuReads))};
}

Result<SlavePlan> plan_slave(std::uint8_t node, const ProcessArea& area, const ProcessMapping& mapping,
                             std::uint32_t logical) {
  const auto out = bytes_of(mapping.outputs);
  const auto in = bytes_of(mapping.inputs);
  if (!area.exists())
    return fail(drive_error(Errc::usage, node, "the location of its process data is unknown",
                            "its SII lists no sync managers: name its family or its ESI file with -d"));
  if (out + in > kMaxDatagramData)
    return fail(
        drive_error(Errc::usage, node,
                    message("its process data have {} bytes, a frame holds {}", out + in, kMaxDatagramData),
                    "map fewer objects: `pdo map`"));
  const bool out_first = area.out_start < area.in_start;
  const auto room =
      static_cast<std::size_t>(out_first ? area.in_start - area.out_start : area.out_start - area.in_start);
  const auto needed = (out_first ? out : in) * kBuffers;
  if (needed > room)
    return fail(
        drive_error(Errc::usage, node,
                    message("its {} need {} bytes of its memory (three buffers), and {} are available",
                            out_first ? "outputs" : "inputs", needed, room),
                    "map fewer objects: `pdo map`"));
  return SlavePlan{area, logical, static_cast<std::uint16_t>(out), static_cast<std::uint16_t>(in)};
}

}  // namespace servoctl::ethercat
