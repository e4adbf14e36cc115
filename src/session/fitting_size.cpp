#include "session/fitting_size.hpp"

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::session {

bool is_refused_length(const Error& error) {
  namespace abort = canopen::sdo_abort;
  return error.abort_code == abort::kLength || error.abort_code == abort::kTooLong ||
         error.abort_code == abort::kTooShort;
}

std::optional<Bytes> in_size(const Bytes& data, od::DataType type, std::size_t size) {
  constexpr std::size_t kMost = 8;
  if (!od::is_integer(type) || data.empty() || size == 0 || size > kMost || data.size() > kMost)
    return std::nullopt;
  const bool negative = od::is_signed(type) && (data.back() & 0x80U) != 0;
  const std::uint8_t filling = negative ? 0xFF : 0;
  auto out = data;
  for (; out.size() > size; out.pop_back())
    if (out.back() != filling) return std::nullopt;
  const bool still_negative = od::is_signed(type) && (out.back() & 0x80U) != 0;
  if (still_negative != negative) return std::nullopt;
  out.resize(size, filling);
  return out;
}

Result<void> download_in_size(Session& session, std::uint8_t node, ObjectAddress object, const Bytes& data,
                              od::DataType type, std::optional<std::size_t>* told) {
  auto written = session.download(node, object, data);
  if (written || !is_refused_length(written.error())) return written;
  const auto held = session.upload(node, object);
  if (!held || held->size() == data.size()) return written;
  const auto fitting = in_size(data, type, held->size());
  if (!fitting)
    return fail(drive_error(
        Errc::refused, node, object,
        message("has {} bytes in this drive, not {}: the number does not fit", held->size(), data.size()),
        "nothing was written to it"));
  written = session.download(node, object, *fitting);
  if (written && told != nullptr) *told = held->size();
  return written;
}

}  // namespace servoctl::session
