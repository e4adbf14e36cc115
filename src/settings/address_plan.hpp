#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::settings {

/// One drive that is to have another address: a line of a plan.
struct AddressRow {
  std::uint8_t node = 0;
  std::uint8_t to = 0;
  std::optional<std::uint32_t> serial;   ///< 1018h:04 of the drive that is meant.
  std::optional<std::uint32_t> bitrate;  ///< bit/s
  std::string family;                    ///< Empty: that of the line, or of the cabinet.
  std::uint32_t line = 0;                ///< Of the file, from 1.
};

/// Reads a plan: CSV with the columns `node` and `new`, and `family`, `serial` and `bitrate` where they are
/// wanted.
/// Errc::file with its line for another column, a number that is no node-ID, and a node that appears twice in
/// one of the two columns, and for two bitrates.
Result<std::vector<AddressRow>> parse_address_plan(std::string_view csv, std::string_view file);

/// The bitrate that drives of a plan are to have from their next start on; empty where it has none.
std::optional<std::uint32_t> bitrate_of(std::span<const AddressRow> rows);

/// What a plan is about to do, with so many steps left; `then` is what follows its bitrate, and may be empty.
std::string question_address_plan(std::span<const AddressRow> rows, std::size_t steps,
                                  const std::string& then);

/// One drive moves.
struct AddressStep {
  std::size_t row = 0;  ///< Whose drive it is.
  std::uint8_t from = 0;
  std::uint8_t to = 0;
};

/// The steps of a plan in an order in which no drive moves to where another one is: a drive waits until its
/// place was left, and where drives wait for each other in a circle one of them goes to a free node-ID first.
/// `taken` are the node-IDs that others on the bus use. Errc::refused when a new node-ID is taken by one that
/// does not move, or no node-ID is free for a circle.
Result<std::vector<AddressStep>> order_address_steps(std::span<const AddressRow> rows,
                                                     const std::set<std::uint8_t>& taken);

}  // namespace servoctl::settings
