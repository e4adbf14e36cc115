#pragma once

#include "settings/dictionary_check.hpp"

/// The values that a drive holds, written back to the objects that they were read from: whether they can be
/// written, and in what size, only a write shows.
namespace servoctl::settings {

/// What is written back: settings from 2000h on that were read in the size of the file. Not written are
/// commands, targets, readings, domains, PDOs, passwords, addresses, and what energises a motor, each by the
/// family's data and, where no data say it, by the words of its name.
std::vector<ObjectAddress> writable_back(const show::Desk& desk, const od::EdsFile& file,
                                         const DictionaryCheck& check);

/// Asks, then writes each value once and reads it back. Only while the statusword shows that the power stage
/// is off. Adds to the findings what the drive refuses. Errc::refused if nobody agrees or the drive is
/// enabled, Errc::negative if an object holds another value afterwards; the errors of a write.
Result<void> write_back(show::Desk& desk, const od::EdsFile& file, DictionaryCheck& check);

}  // namespace servoctl::settings
