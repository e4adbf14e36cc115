
#include "base/format.hpp"
#include "settings/backup_formats.hpp"

namespace servoctl::settings {
namespace {

/// Takes numbers and bytes off the front; empty when fewer are left.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : rest_(bytes) {}

  std::optional<Bytes> take(std::size_t size) {
    if (size > rest_.size()) return std::nullopt;
    Bytes out(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(size));
    rest_.remove_prefix(size);
    return out;
  }
  std::optional<std::uint32_t> number(std::size_t size) {
    const auto bytes = take(size);
    return bytes ? std::optional(static_cast<std::uint32_t>(load_le(*bytes))) : std::nullopt;
  }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

std::optional<Backup::Entry> take_entry(Taker& taker) {
  const auto index = taker.number(2);
  const auto sub = taker.number(1);
  const auto size = taker.number(4);
  auto data = size ? taker.take(*size) : std::nullopt;
  if (!index || !sub || !data) return std::nullopt;
  Backup::Entry out;
  out.object = {static_cast<std::uint16_t>(*index), static_cast<std::uint8_t>(*sub)};
  out.bytes = std::move(*data);
  return out;
}

}  // namespace

Result<Backup> read_concise_dcf(std::string_view bytes, const std::string& file) {
  constexpr std::string_view kHint = "is it a concise DCF (CiA 302-3, object 1F22h)?";
  Taker taker(bytes);
  const auto count = taker.number(4).value_or(0);
  Backup out;
  for (std::uint32_t number = 1; number <= count; ++number) {
    auto entry = take_entry(taker);
    if (!entry)
      return fail(Errc::file,
                  message("{}:{}: the file ends within this entry, of {}", as_it_is(file), number, count),
                  std::string(kHint));
    entry->line = number;
    out.entries.push_back(std::move(*entry));
  }
  if (taker.left() > 0)
    return fail(Errc::file,
                message("{}: {} bytes follow the last of {} entries", as_it_is(file), taker.left(), count),
                std::string(kHint));
  if (count == 0)
    return fail(Errc::file, message("{}: there is no entry in it", as_it_is(file)), std::string(kHint));
  return out;
}

}  // namespace servoctl::settings
