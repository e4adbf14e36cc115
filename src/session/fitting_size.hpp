#pragma once

#include <optional>

#include "base/bytes.hpp"
#include "od/data_type.hpp"
#include "session/session.hpp"

/// Objects that have another size in the drive than in the data about it.
namespace servoctl::session {

/// Whether the drive refused a write because of its length (CiA 301, 7.2.4.3.17).
bool is_refused_length(const Error& error);

/// The same integer in so many bytes; empty where it does not fit, or is none. `type` tells whether it has a
/// sign.
std::optional<Bytes> in_size(const Bytes& data, od::DataType type, std::size_t size);

/// Writes an integer. Where the drive refuses its length, the object is read, and the same number is written
/// in the size that it has there; `told` becomes that size. Errc::refused where the number does not fit.
Result<void> download_in_size(Session& session, std::uint8_t node, ObjectAddress object, const Bytes& data,
                              od::DataType type, std::optional<std::size_t>* told = nullptr);

}  // namespace servoctl::session
