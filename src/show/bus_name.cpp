#include "show/bus_name.hpp"

#include <cctype>
#include <cstdint>

#include "base/format.hpp"
#include "session/open_bus.hpp"

namespace servoctl::show {
namespace {

/// Tells names apart that are the same without their punctuation (FNV-1a).
std::uint32_t hash_of(std::string_view text) {
  std::uint32_t out = 0x811C9DC5;
  for (const char c : text) out = (out ^ static_cast<unsigned char>(c)) * 0x01000193;
  return out;
}

}  // namespace

std::string bus_name(std::string_view url) {
  constexpr std::size_t kMost = 100;
  const auto bus = session::canonical_url(url);
  auto out = bus.substr(0, kMost);
  for (auto& c : out)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  return out == bus ? out : formatted("{}-{:08x}", out, hash_of(bus));
}

}  // namespace servoctl::show
