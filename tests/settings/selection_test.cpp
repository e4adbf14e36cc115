#include "settings/selection.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "drive/profile.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {
namespace {

drive::Profile loaded(const char* family) {
  return drive::load_profile(family, std::vector{std::filesystem::path(source_dir()) / "eds"}).value();
}

bool has(const drive::Profile& profile, std::string_view part, ObjectAddress object) {
  const auto selection = selection_of(profile, part);
  EXPECT_TRUE(selection);
  return selection && (*selection)(object);
}

/// Which of the fixed PDOs are exchanged is the better part of what is to be said of them.
TEST(Selection, OfPdosHasTheirAssignment) {
  const auto profile = loaded("sv2");
  for (const ObjectAddress object :
       {ObjectAddress{0x1C12, 0}, ObjectAddress{0x1C13, 1}, ObjectAddress{0x1600, 1}})
    EXPECT_TRUE(has(profile, "pdo", object)) << to_string(object);
  EXPECT_FALSE(has(profile, "pdo", {0x6083, 0}));
  EXPECT_FALSE(has(loaded("gsd600"), "pdo", {0x1C12, 0}));
}

/// Without them what was restored is gone after power-off.
TEST(Selection, OfPdosAndCommunicationHasTheParametersThatStoreThem) {
  const auto profile = loaded("gsd600");
  std::size_t of_pdos = 0;
  for (const auto& parameter : profile.parameters) {
    if (!parameter.object || !parameter.mirror) continue;
    const bool of_pdo = parameter.mirror->index >= 0x1400 && parameter.mirror->index < 0x1C00;
    if (of_pdo) ++of_pdos;
    EXPECT_EQ(has(profile, "pdo", *parameter.object), of_pdo) << parameter.id;
    EXPECT_EQ(has(profile, "communication", *parameter.object), parameter.mirror->index < 0x2000)
        << parameter.id;
  }
  EXPECT_GT(of_pdos, 20U);
  EXPECT_FALSE(has(profile, "communication", *profile.parameter("Pn0202")->object));
}

TEST(Selection, OfAGroupHasItsParametersAndAnUnknownOneIsRefused) {
  const auto profile = loaded("gsd600");
  EXPECT_TRUE(has(profile, "gain", *profile.parameter("Pn0202")->object));
  EXPECT_FALSE(has(profile, "gain", *profile.parameter("Pn0100")->object));
  EXPECT_EQ(selection_of(profile, "gian").error().code, Errc::usage);
}

}  // namespace
}  // namespace servoctl::settings
