#include "settings/stored_eds.hpp"

#include <cstdint>
#include <string_view>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"
#include "od/eds.hpp"
#include "session/answer.hpp"
#include "session/wary.hpp"

namespace servoctl::settings {
namespace {

constexpr ObjectAddress kStoredEds{0x1021, 0};
constexpr ObjectAddress kStoredFormat{0x1022, 0};
/// Far above any EDS of a drive, and little enough to be kept in memory.
constexpr std::size_t kLongestStored = std::size_t{4} << 20U;

bool is_absence(const Error& error) {
  return error.abort_code == canopen::sdo_abort::kNoObject ||
         error.abort_code == canopen::sdo_abort::kNoSubIndex;
}

/// Why it is not to be used; empty if it is.
Result<std::string> objection(session::ObjectSurvey& survey, const std::string& text,
                              const session::Identity& identity) {
  const auto read = od::read_eds(text, "1021h");
  if (read) {
    const auto& device = read->device;
    // 0: the file names none.
    const auto agrees = [](std::uint32_t said, std::optional<std::uint32_t> number) {
      return said == 0 || said == number;
    };
    const bool is_of_drive = agrees(device.vendor_number, identity.vendor_id) &&
                             agrees(device.product_number, identity.product_code);
    return is_of_drive
               ? std::string()
               : formatted("it is for vendor {:08X}h, product {:08X}h; the drive (1018h) is another one",
                           device.vendor_number, device.product_number);
  }
  const auto format = survey.read(std::span(&kStoredFormat, 1));
  if (!format) return fail(format.error());
  const auto number = session::number_in(format->front());
  return formatted("its {} bytes are no EDS (format {} in 1022h)", text.size(),
                   number ? formatted("{}", *number) : std::string("-"));
}

}  // namespace

Result<std::optional<std::string>> stored_eds(show::Desk& desk, session::ObjectSurvey& survey,
                                              const session::Identity& identity) {
  const std::optional<std::string> none;
  if (!session::access_alarm(*desk.session, identity.node, kStoredEds).empty()) return none;
  survey.set_longest(kLongestStored);
  const auto answers = survey.read(std::span(&kStoredEds, 1));
  if (!answers) return fail(answers.error());
  const auto& bytes = answers->front();
  const auto tell = [&](const Message& why) {
    desk.notices.push_back(message("the EDS that the drive stores (1021h) is not used: {}", why));
    return none;
  };
  if (!bytes) return is_absence(bytes.error()) ? none : tell(bytes.error().message);
  std::string text(bytes->begin(), bytes->end());
  while (!text.empty() && text.back() == '\0') text.pop_back();
  const auto why = objection(survey, text, identity);
  if (!why) return fail(why.error());
  return why->empty() ? std::optional(std::move(text)) : tell(*why);
}

}  // namespace servoctl::settings
