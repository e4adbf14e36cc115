#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::drive {

/// A table of a family made of one that somebody has.
struct ConvertedTable {
  std::string csv;  ///< With its header line; empty: there is nothing usable.
  std::size_t rows = 0;
  std::vector<Message> notices;  ///< What was left out or taken in a certain way, with its line.
};

/// A table of parameters as spreadsheets and manuals have it: any of the usual English or Chinese headings,
/// in any order, perhaps below a title; commas, semicolons or tabs; any encoding od::to_utf8() knows. What it
/// does not say of an object is taken from the dictionary. Adds to `errors`, with its line, what cannot be
/// understood.
ConvertedTable convert_parameters(std::string_view bytes, std::string_view file,
                                  const od::Dictionary& dictionary, std::vector<Error>& errors);

/// The same of a table of faults.
ConvertedTable convert_faults(std::string_view bytes, std::string_view file, std::vector<Error>& errors);

}  // namespace servoctl::drive
