#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

/// A picture that stands in a page itself.
struct Logo {
  std::string type;    ///< `image/png`, `image/jpeg` or `image/svg+xml`; empty: there is none.
  std::string base64;  ///< The file.

  /// As RFC 2397 has it; empty where there is none.
  std::string uri() const { return type.empty() ? std::string() : "data:" + type + ";base64," + base64; }
};

/// For whom a report is made, and by whom: what people said of it. Empty: it was not said.
struct ReportCover {
  std::string title;
  std::string customer;
  std::string machine;
  std::string operator_name;
  Logo logo;
  std::vector<std::string> signatures;  ///< Who signs, one line each.
};

/// What people typed.
struct CoverWords {
  std::string_view title;
  std::string_view customer;
  std::string_view machine;
  std::string_view operator_name;
  std::filesystem::path logo;
  std::string_view
      signatures;  ///< `Commissioning engineer,Customer`, `none`; empty: what the customer asks for.
};

/// In the language of the desk; a report for a customer is signed by the commissioning engineer and the
/// customer unless the words say otherwise. Blank text is as none. Errc::usage for text that is longer than
/// two lines of the page, or has characters that control or hide, and for a signature of nobody; Errc::file
/// for a logo that cannot be read, is larger than 1 MiB, or is no whole PNG, JPEG or SVG. Needs no bus.
Result<ReportCover> read_cover(const show::Desk& desk, const CoverWords& words);

}  // namespace servoctl::trial
