#include "ethercat/mailbox_message.hpp"

#include <algorithm>

#include "ethercat/words.hpp"

namespace servoctl::ethercat {

std::optional<MailboxView> parse_mailbox(ByteSpan mailbox) {
  if (mailbox.size() < kMailboxHeader) return std::nullopt;
  const std::size_t length = word_at(mailbox, 0);
  if (length > mailbox.size() - kMailboxHeader) return std::nullopt;
  MailboxView out;
  out.type = static_cast<MailboxType>(mailbox[5] & 0x0FU);
  out.counter = mailbox[5] >> 4U & 0x07U;
  out.data = mailbox.subspan(kMailboxHeader, length);
  return out;
}

Bytes mailbox_bytes(MailboxType type, std::uint8_t counter, ByteSpan data, std::size_t size) {
  Bytes out(std::max(size, kMailboxHeader + data.size()));
  store_le(data.size(), std::span(out).first(2));
  out[5] = static_cast<std::uint8_t>(static_cast<unsigned>(type) | static_cast<unsigned>(counter) << 4U);
  std::copy(data.begin(), data.end(), out.begin() + kMailboxHeader);
  return out;
}

std::uint8_t next_mailbox_counter(std::uint8_t counter) {
  return counter >= 7 ? std::uint8_t{1} : static_cast<std::uint8_t>(counter + 1);
}

std::string mailbox_error_text(std::uint16_t detail) {
  switch (detail) {
    case 1: return "syntax error in the message header";
    case 2: return "the protocol is not supported";
    case 3: return "invalid channel";
    case 4: return "the service is not supported";
    case 5: return "invalid protocol header";
    case 6: return "the message is too short";
    case 7: return "no memory available";
    case 8: return "inconsistent length";
    default: return "reason not listed in ETG.1000.4";
  }
}

}  // namespace servoctl::ethercat
