#pragma once

#include "settings/lss_bitrate.hpp"

namespace servoctl::settings {

/// Takes all slaves to the configuration state, and asks each for its node-ID: one answer a slave.
Result<session::LssDialogue::Answers> all_lss_answers(session::LssDialogue& lss);

}  // namespace servoctl::settings
