#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::drive {

/// One parameter of somebody's table, its cells as the table of a family has them.
struct ForeignRow {
  std::uint32_t line = 0;
  std::string id, object, type, access, unit, scale, low, high, standard, effect, labels, labels_zh, name,
      name_zh, group, assumed, note, note_zh;
  const od::Entry* entry = nullptr;  ///< In the data sheet; null where the parameter has no object there.

  std::string csv() const;
};

/// The heading of such rows.
extern const std::string_view kForeignRowHeader;

/// Makes default and limits raw where the table shows numbers in the unit. Which it does, a decimal point or
/// the data sheet proves. Adds an error for proofs of both and for a number that is no whole raw one, and a
/// notice that says how the numbers were taken where a row does not prove it by itself. Where nothing proves
/// it they are marked as assumed. False: there are proofs of both.
bool settle_numbers(std::vector<ForeignRow>& rows, std::string_view file, std::vector<Error>& errors,
                    std::vector<Message>& notices);

/// What a table does not say and the data sheet does. Where they contradict each other in type or access, or
/// a limit is wider than that of the data sheet, the data sheet is used, with a notice; a default that
/// differs is told. Under a scale a default that differs or a wider limit is an error: every number written
/// would be wrong by a factor if the scale is.
void add_from_sheet(ForeignRow& row, std::string_view file, std::vector<Error>& errors,
                    std::vector<Message>& notices);

/// A default as od::parse_value() reads it; empty where there is none that holds for every node.
std::string text_of(const std::optional<od::NodeValue>& value);

}  // namespace servoctl::drive
