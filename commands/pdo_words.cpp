// How PDOs, mapped objects and CAN-IDs are written on the command line.
#include <fmt/format.h>

#include "base/number.hpp"
#include "base/text.hpp"
#include "commands/pdo_changing.hpp"
#include "commands/pdo_check.hpp"
#include "drive/naming.hpp"

namespace servoctl::commands {
namespace {

using canopen::PdoEntry;

/// The data type that stands for a gap of so many bits (CiA 301, 7.4.8.2).
std::optional<std::uint16_t> gap_of(std::uint64_t bits) {
  switch (bits) {
    case 1: return std::uint16_t{0x0001};
    case 8: return std::uint16_t{0x0005};
    case 16: return std::uint16_t{0x0006};
    case 32: return std::uint16_t{0x0007};
    default: return std::nullopt;
  }
}

constexpr std::string_view kNodeId = "$NODEID+";

}  // namespace

Result<PdoEntry> parse_mapped(const drive::Profile& profile, std::string_view text) {
  if (starts_with_nocase(text, "gap")) {
    const auto bits = parse_digits(text.substr(3), 10);
    const auto type = bits ? gap_of(*bits) : std::nullopt;
    if (type) return PdoEntry{{*type, 0}, static_cast<std::uint8_t>(*bits)};
  }
  const auto slash = text.rfind('/');
  const auto target = drive::resolve(&profile, text.substr(0, slash));
  if (!target) return tl::unexpected<Error>(target.error());
  if (slash != std::string_view::npos) {
    const auto bits = parse_digits(text.substr(slash + 1), 10);
    if (!bits || *bits == 0 || *bits > 64)
      return fail(Errc::usage, fmt::format("'{}': behind the / stands the number of bits, 1 to 64", text));
    return PdoEntry{target->address, static_cast<std::uint8_t>(*bits)};
  }
  const auto bits = bits_of(profile, target->address);
  if (!bits && !profile.is_generic() && profile.dictionary.find(target->address) == nullptr)
    return fail(Errc::usage,
                fmt::format("{} is not in the dictionary of {}", to_string(target->address), profile.family),
                fmt::format("`objects -d {}` lists what can be mapped", profile.family));
  if (!bits || *bits == 0)
    return fail(Errc::usage, fmt::format("the length of {} is not known", text),
                fmt::format("say its bits: {}/16", to_string(target->address)));
  return PdoEntry{target->address, *bits};
}

Result<std::uint32_t> parse_can_id(std::string_view text, std::uint8_t node) {
  const bool plus_node = starts_with_nocase(text, kNodeId);
  const auto number = parse_integer(plus_node ? text.substr(kNodeId.size()) : text);
  const auto value = number ? number->as_unsigned() : std::nullopt;
  const auto can_id = value.value_or(0) + (plus_node ? node : 0U);
  if (!value || *value > 0x7FF || can_id > 0x7FF)
    return fail(Errc::usage, fmt::format("'{}' is no CAN-ID of a PDO", text),
                "a number up to 0x7FF, or $NODEID+0x180");
  return static_cast<std::uint32_t>(can_id);
}

std::optional<std::uint32_t> predefined_can_id(const canopen::Pdo& pdo, std::uint8_t node) {
  if (pdo.number > 4) return std::nullopt;
  const auto first = pdo.direction == canopen::PdoDirection::receive ? 0x200U : 0x180U;
  return first + 0x100U * (pdo.number - 1U) + node;
}

}  // namespace servoctl::commands
