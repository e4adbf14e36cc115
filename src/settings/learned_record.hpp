#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "od/eds.hpp"
#include "report/value.hpp"
#include "session/object_scan.hpp"

namespace servoctl::settings {

/// What is written, and where it comes from.
struct Learned {
  std::string_view source;
  std::string text;
  std::string ranges = {};
  bool resumed = false;
  std::vector<session::ScanRefusal> left_out = {};
};

/// `{node file source objects entries write_only ranges resumed left_out[]}` of a file that was written.
report::Record learned_record(const Learned& learned, const od::EdsFile& sheet, std::uint8_t node,
                              const std::filesystem::path& file);

}  // namespace servoctl::settings
