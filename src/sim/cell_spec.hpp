#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "drive/profile.hpp"
#include "sim/drive_model.hpp"
#include "sim/memory.hpp"

namespace servoctl::sim {

/// A text of simulated drives taken apart, `gsd600@1,gsd600@2?state=FILE&delay=20ms`: what all wires have in
/// common. Its views are of that text.
struct CellSpec {
  struct Place {
    std::string family;     ///< In lower case, unless it is the path of a file.
    std::uint8_t node = 1;  ///< 1..127; with the option `lss` also 255, no node-ID yet.
  };
  struct Option {
    std::string_view key;
    std::string_view value;  ///< Empty without a `=`.
  };

  std::vector<Place> places;    ///< One at least.
  std::vector<Option> options;  ///< In their order.
  std::string_view example;     ///< As parse_cell_spec() was given it.

  /// Whether the option was given, with a value or without.
  bool has(std::string_view key) const;
  /// Errc::usage; the hint is how such drives are written.
  tl::unexpected<Error> wrong(Message what) const;
};

/// Errc::usage for what is wrong in the text; `example` is its hint, and outlives the answer.
Result<CellSpec> parse_cell_spec(std::string_view text, std::string_view example);

/// The memory in the file that `state=FILE` names; without it one that is lost with the process.
Result<std::unique_ptr<Memory>> open_memory(const CellSpec& spec);

/// The data of a family; `known` holds it from now on. Errors as drive::load_profile().
Result<const drive::Profile*> profile_of(std::vector<std::shared_ptr<const drive::Profile>>& known,
                                         const std::string& family,
                                         std::span<const std::filesystem::path> folders);

/// The time of an option such as `delay=20ms`; Errc::usage, with the key.
Result<Duration> time_of(const CellSpec& spec, const CellSpec::Option& option);

/// The words of `lie=WORD,WORD`: ways in which simulated drives deviate from the standard. Errc::usage for a
/// word that is not one of `known`, which the message lists.
Result<std::vector<std::string_view>> lies_of(const CellSpec& spec, const CellSpec::Option& option,
                                              std::span<const std::string_view> known);

/// Applies an option that is about the drives, whatever wire they hang on: `fault=CODE@TIME`, `counts=N`,
/// `panel=NAME=VALUE`; false for any other. Times count from `now`.
Result<bool> apply_drive_option(const CellSpec& spec, const CellSpec::Option& option,
                                std::span<DriveModel* const> drives, TimePoint now);

}  // namespace servoctl::sim
