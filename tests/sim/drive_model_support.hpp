#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drive/standard_objects.hpp"
#include "od/value.hpp"
#include "sim/drive_model.hpp"
#include "tests/sim/commissioned.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {

inline constexpr ObjectAddress kTargetVelocity{0x60FF, 0};

/// A drive model by itself, set up to obey its bus: no bus, no frame, and no port but one that the test
/// makes.
class DriveModelTest : public testing::Test {
 protected:
  void build(const std::string& family) {
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    auto loaded = drive::load_profile(family, folders);
    ASSERT_TRUE(loaded) << loaded.error().message.text();
    profile_ = std::make_unique<drive::Profile>(std::move(*loaded));
    model_ = std::make_unique<DriveModel>(*profile_, 1, memory_, family);
    commission(*model_);
    model_->power_on(now_);
  }

  DriveModel& model() { return *model_; }
  bool has(ObjectAddress object) const { return profile_->dictionary.find(object) != nullptr; }
  std::size_t size_of(ObjectAddress object) const {
    return od::size_of(profile_->dictionary.find(object)->type).value();
  }

  /// The abort code, or 0.
  std::uint32_t write(ObjectAddress object, std::uint64_t value) {
    return model().write(object, store_le(value, size_of(object)));
  }
  Bytes read(ObjectAddress object) {
    Bytes out;
    EXPECT_EQ(model().read(object, out), 0U) << to_string(object);
    return out;
  }
  std::uint64_t number(ObjectAddress object) { return load_le(read(object)); }
  double amount(ObjectAddress object) {
    return od::to_double(od::decode(profile_->dictionary.find(object)->type, read(object)).value());
  }
  drive::DriveState state() {
    return drive::decode_state(static_cast<std::uint16_t>(number(objects::kStatusword)));
  }

  void run(Duration time) {
    for (const auto end = now_ + time; now_ < end;) {
      now_ += std::chrono::milliseconds(1);
      model().on_time(now_);
    }
  }
  void power_cycle() {
    run(std::chrono::seconds(1));
    model().power_on(now_);
  }
  /// In the mode in which it follows 60FFh.
  void enable() {
    const auto mode = static_cast<std::uint64_t>(profile_->rules.motion.velocity.value_or(3));
    ASSERT_EQ(write(objects::kModeOfOperation, mode), 0U);
    for (const auto word : {6U, 7U, 15U}) ASSERT_EQ(write(objects::kControlword, word), 0U);
    ASSERT_EQ(state(), drive::DriveState::operation_enabled);
  }
  /// The emergencies that were not taken yet.
  std::vector<Emergency> told() {
    std::vector<Emergency> out;
    while (const auto one = model().take_emergency()) out.push_back(*one);
    return out;
  }

  TimePoint now_{std::chrono::seconds(1)};
  Memory memory_;
  std::unique_ptr<drive::Profile> profile_;
  std::unique_ptr<DriveModel> model_;
};

class DriveModelOf : public DriveModelTest, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { build(GetParam()); }
};

inline constexpr const char* kFamilies[] = {"gsd600", "dm", "da200", "ts", "sv2", "cia402"};
inline std::string family_of(const testing::TestParamInfo<const char*>& test) { return test.param; }

}  // namespace servoctl::sim
