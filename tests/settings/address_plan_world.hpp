#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>
#include <string>

#include "settings/address_journal.hpp"
#include "settings/address_plan_run.hpp"
#include "tests/settings/address_world.hpp"

namespace servoctl::settings {

namespace fs = std::filesystem;

/// A plan of addresses in a folder of its own.
class PlanOfAddresses : public testing::Test {
 protected:
  PlanOfAddresses() { fs::create_directories(folder_); }
  ~PlanOfAddresses() override { fs::remove_all(folder_); }

  Result<report::Value> run(AddressWorld& world, bool resume = false) {
    return run_address_plan(world.desk, text_, file_, {.each = {}, .resume = resume});
  }
  std::string nodes(const AddressWorld& world) const {
    std::string out;
    for (const auto& drive : world.drives) out += fmt::format("{}{}", out.empty() ? "" : " ", drive->node());
    return out;
  }
  bool has_journal() const { return fs::exists(address_journal_of(file_)); }

  const fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("servoctl-address-{}", ::getpid());
  const fs::path file_ = folder_ / "plan.csv";
  std::string text_ = "node,new\n1,2\n2,3\n3,1\n4,14\n";
};

}  // namespace servoctl::settings
