#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/value.hpp"
#include "session/family_check.hpp"
#include "show/desk.hpp"

/// What a first contact with a real drive showed, for those who write the data of its family. Nothing in it
/// is the customer's: no value of a setting, no serial number, no node-ID, no name.
namespace servoctl::trial {

/// What one object answered.
struct Answer {
  ObjectAddress object;
  std::optional<std::size_t> size;          ///< Bytes of the answer.
  std::optional<std::uint32_t> abort_code;  ///< Of the refusal.
};

/// Where the drive is not as the data say.
struct Difference {
  ObjectAddress object;
  std::string kind;  ///< `refused size range`
  std::string data;  ///< What the data say.
  std::string drive;
};

struct Witness {
  session::Identity identity;          ///< As far as the drive may be asked for it.
  std::optional<std::uint32_t> modes;  ///< 6502h
  session::FamilyVerdict verdict;
  std::vector<Answer> answers;
  std::vector<Difference> differences;
  std::size_t write_only = 0;  ///< Objects that were not asked for because of that.
  std::size_t domains = 0;     ///< The same of data of any length.
  std::optional<Error> ended;  ///< Why not all was asked for.

  std::size_t refused() const;
};

/// Reads every object that the family's data list as readable, one after the other, and writes nothing. Where
/// the data say that a wrong access is an alarm of the drive, nothing else is asked for; else also its
/// identity. A fault of the drive, or silence, ends the tour. Errc::timeout when nothing was answered.
Result<Witness> witness(show::Desk& desk, std::uint8_t node, std::span<const drive::Family> families);

/// The file.
report::Record witness_document(const show::Desk& desk, const Witness& witness);

}  // namespace servoctl::trial
