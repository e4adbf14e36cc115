#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"

namespace servoctl::ethercat {

/// What a message of a mailbox speaks (ETG.1000.4, 5.6).
enum class MailboxType : std::uint8_t { error = 0, aoe = 1, eoe = 2, coe = 3, foe = 4, soe = 5, voe = 15 };

inline constexpr std::size_t kMailboxHeader = 6;

/// One message of a mailbox, as a view into its bytes.
struct MailboxView {
  MailboxType type = MailboxType::error;
  std::uint8_t counter = 0;  ///< 1 to 7 and round; 0: not counted.
  ByteSpan data;             ///< Behind the header.
};

/// The message that a mailbox of this size holds; empty when its length leads out of it.
std::optional<MailboxView> parse_mailbox(ByteSpan mailbox);
/// The whole mailbox of `size` bytes, zeros behind the data: its last byte hands it over. `data` has at most
/// `size - kMailboxHeader` bytes.
Bytes mailbox_bytes(MailboxType type, std::uint8_t counter, ByteSpan data, std::size_t size);
/// The counter behind this one: 1 behind 7.
std::uint8_t next_mailbox_counter(std::uint8_t counter);

/// What the answer of type `error` says about a message (ETG.1000.4, 5.6, table 30): a phrase without a full
/// stop.
std::string mailbox_error_text(std::uint16_t detail);

}  // namespace servoctl::ethercat
