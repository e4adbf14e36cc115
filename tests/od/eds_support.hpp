#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "od/eds.hpp"

namespace servoctl::od {

/// The file; a failure of the test when it is refused.
inline EdsFile read_sheet(std::string_view text) {
  auto file = read_eds(text, "x.eds");
  EXPECT_TRUE(file) << (file ? "" : file.error().message.text());
  return file.value_or(EdsFile{});
}

/// The same without findings about what a whole data sheet has, and a test of one object has not.
inline EdsFile read(std::string_view text) {
  auto file = read_sheet(text);
  std::erase_if(file.diagnostics, [](const Diagnostic& d) {
    return d.rule == "missing-device-info" || d.rule == "missing-mandatory-object" ||
           d.rule == "missing-sub-0";
  });
  return file;
}

/// `7:9 leading-zero` of every finding: line, column, rule.
inline std::vector<std::string> findings(const EdsFile& file) {
  std::vector<std::string> out;
  for (const auto& d : file.diagnostics) {
    EXPECT_FALSE(d.message.empty()) << d.rule;
    EXPECT_FALSE(d.remedy.empty()) << d.rule;
    out.push_back(std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.rule);
  }
  return out;
}

using Rules = std::vector<std::string>;

/// One variable with these further lines.
inline std::string variable(std::string_view index, std::string_view type, std::string_view more) {
  return "[" + std::string(index) + "]\nParameterName=X\nDataType=" + std::string(type) +
         "\nAccessType=rw\n" + std::string(more) + "\n";
}

/// One that nothing is found about.
inline const std::string kGood = variable("2FFF", "7", "");

inline std::string bytes(std::initializer_list<int> list) {
  std::string out;
  for (const int byte : list) out += static_cast<char>(byte);
  return out;
}

inline std::string default_of(const EdsFile& file, ObjectAddress address) {
  const auto* entry = file.dictionary.find(address);
  return entry == nullptr || !entry->default_value ? "none" : to_string(entry->default_value->for_node(5));
}

inline std::vector<std::string> numbers(int from, int to) {
  std::vector<std::string> out;
  for (int i = from; i <= to; ++i) out.push_back(std::to_string(i));
  return out;
}

}  // namespace servoctl::od
