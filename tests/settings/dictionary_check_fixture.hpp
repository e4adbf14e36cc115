#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <utility>

#include "lying_node.hpp"
#include "settings/dictionary_check.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {

using Found = std::set<std::pair<ObjectAddress, Difference>>;

inline std::string listed_text(const Found& found) {
  std::string out;
  for (const auto& [object, difference] : found)
    out += to_string(object) + " " + std::string(name(difference)) + "\n";
  return out;
}

/// The data sheet of a family, and node 1 with its objects, which a test lets lie.
class DictionaryCheckTest : public testing::Test {
 protected:
  DictionaryCheckTest()
      : standard(drive::load_profile("cia402", kFolders).value()),
        family(drive::load_profile("gsd600", kFolders).value()) {
    file.dictionary = family.dictionary;
    for (const auto& object : family.dictionary.objects())
      for (const auto& entry : object.entries) file.dictionary.find(entry.address)->is_volatile = false;
  }

  LyingNode& node() {
    if (!node_) node_ = std::make_unique<LyingNode>(family.dictionary);
    return *node_;
  }
  Result<DictionaryCheck> check(const CheckOptions& options = {}) {
    desk.session = &*node().session;
    desk.standard = &standard;
    return check_dictionary(desk, 1, file, options);
  }
  Found found(const CheckOptions& options = {}) {
    const auto checked = check(options);
    EXPECT_TRUE(checked) << checked.error().message.text();
    Found out;
    if (checked)
      for (const auto& each : checked->findings) out.emplace(each.object, each.difference);
    return out;
  }

  drive::Profile standard;
  drive::Profile family;
  od::EdsFile file;
  show::Desk desk;
  std::unique_ptr<LyingNode> node_;
};

}  // namespace servoctl::settings
