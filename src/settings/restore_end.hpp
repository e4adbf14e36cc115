#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "drive/profile.hpp"
#include "session/restore.hpp"

namespace servoctl::settings {

/// How a restore ended.
enum class RestoreEnd : std::uint8_t {
  idle,           ///< Nothing differed, and nothing was written.
  planned,        ///< The answer is what would be sent.
  done,           ///< Every value is as wanted.
  not_kept,       ///< Every value is as wanted; keeping it, or locking the drive again, failed.
  rolled_back,    ///< It failed, and every value is as it was before.
  flash_changed,  ///< It failed; the values in force are as they were before, those of the flash may not be.
  astray,         ///< It failed, and some values are neither, or are not known; the errors name them.
  left            ///< It failed, and what was written stays written, as was asked for.
};
RestoreEnd end_of(const session::RestoreOutcome& outcome);
/// The end of one that failed, in words.
std::string_view failed_state(const session::RestoreOutcome& outcome);

/// What is to be told of one that failed: the failure, then what is not as it was.
std::vector<Error> errors_of(const session::RestoreOutcome& outcome, const drive::Profile* profile,
                             std::uint8_t node);
/// The values in force were put back, and these went to the flash before.
Error flash_error(const drive::Profile* profile, std::uint8_t node,
                  const std::vector<ObjectAddress>& in_flash);

/// To go on would be refused in the same way, and so would be to undo it.
bool is_refused_store(const Error& error);

}  // namespace servoctl::settings
