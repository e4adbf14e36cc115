#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "od/esi.hpp"

namespace servoctl::od {

/// An ESI with one device; `body` stands behind its type and name.
inline std::string esi_text(std::string_view body, std::string_view head = "<?xml version=\"1.0\"?>\n") {
  return std::string(head) +
         "<EtherCATInfo><Vendor><Id>#xFAB</Id><Name>Muster</Name></Vendor><Descriptions><Devices><Device>"
         "<Type ProductCode=\"#x2000\" RevisionNo=\"#x30001\">P20</Type><Name>P20 drive</Name>\n" +
         std::string(body) + "</Device></Devices></Descriptions></EtherCATInfo>\n";
}

/// The same with a dictionary of these types and objects.
inline std::string esi_objects(std::string_view objects, std::string_view types = {},
                               std::string_view rest = {}) {
  return esi_text("<Profile><Dictionary><DataTypes>\n" + std::string(types) + "</DataTypes><Objects>\n" +
                  std::string(objects) + "</Objects></Dictionary></Profile>\n" + std::string(rest));
}

/// An object of one value.
inline std::string esi_object(std::string_view index, std::string_view type, std::string_view info = {},
                              std::string_view access = "rw") {
  return "<Object><Index>" + std::string(index) + "</Index><Name>Object</Name><Type>" + std::string(type) +
         "</Type><Info>" + std::string(info) + "</Info><Flags><Access>" + std::string(access) +
         "</Access></Flags></Object>\n";
}

inline EsiFile read_good(std::string_view text, std::string_view device = {}) {
  auto file = read_esi(text, "p20.xml", device);
  EXPECT_TRUE(file) << (file ? "" : file.error().message.text());
  return file ? std::move(*file) : EsiFile{};
}

inline const Diagnostic* finding(const EsiFile& file, std::string_view rule) {
  const auto& all = file.sheet.diagnostics;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Diagnostic& d) { return d.rule == rule; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace servoctl::od
