// What the bits of an object mean, of each axis and family.
#include "show/value_words.hpp"

#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "show/reading.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::show {
namespace {

drive::Profile family(const std::string& name) {
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  return drive::load_profile(name, folders).value();
}

TEST(ValueWords, DigitalInputsAreThoseOfTheFamily) {
  constexpr auto kInputs = objects::kDigitalInputs;
  const auto gsd600 = family("gsd600");
  EXPECT_EQ(value_words(kInputs, 0x003F0004, false, &gsd600), "no limit, no home switch")
      << "its home is low";
  EXPECT_EQ(value_words(kInputs, 0x003F0003, false, &gsd600), "negative limit, positive limit, home switch");
  const auto sv2 = family("sv2");
  EXPECT_EQ(value_words(kInputs, 1, false, &sv2), "home switch (active level assumed)");
  const auto generic = family("cia402");
  EXPECT_EQ(value_words(kInputs, 1, false, &generic), "set bits: 0") << "makers differ in bits and levels";
  EXPECT_EQ(value_words(kInputs, 0x803F0004, false, &generic), "set bits: 2, 16-21, 31");
  EXPECT_EQ(value_words(kInputs, 0, false, &generic), "no bit is set");
  EXPECT_EQ(value_words(kInputs, 1, false, nullptr), "");
}

TEST(ValueWords, ASecondAxisReadsLikeTheFirst) {
  EXPECT_EQ(value_words({0x6841, 0}, 0x0637, false, nullptr),
            value_words(objects::kStatusword, 0x0637, false, nullptr));
  EXPECT_EQ(value_words({0x6840, 0}, 0x000F, false, nullptr), "enable operation");
  EXPECT_EQ(value_words({0x6D02, 0}, 0x0041, false, nullptr), "pp, ip");
}

TEST(ValueWords, ASecondAxisHasThemWhereTheDataListTheFirstAlone) {
  const auto label = [](const drive::Profile& of, ObjectAddress object, const Bytes& bytes) {
    Reading reading;
    reading.target = drive::target_at(&of, object);
    reading.family = &of;
    EXPECT_EQ(reading.target.entry, nullptr);
    return label_text(decode_value(reading, bytes), false);
  };
  const auto gsd600 = family("gsd600");
  EXPECT_EQ(label(gsd600, {0x6841, 0}, {0x37, 0x06}),
            value_words(objects::kStatusword, 0x0637, false, &gsd600));
  EXPECT_EQ(label(gsd600, {0x6840, 0}, {0x0F, 0}), "enable operation");
  EXPECT_EQ(label(gsd600, {0x6D02, 0}, {0x41, 0, 0, 0}), "pp, ip");
  EXPECT_EQ(label(gsd600, {0x68FD, 0}, {4, 0, 0x3F, 0}), "") << "its inputs are of the first axis";
  EXPECT_EQ(label(family("dm"), {0x6D02, 0}, {0x41, 0, 0, 0}), "") << "it has no 6502h itself";
}

TEST(ValueWords, AnErrorRegisterOfZeroSaysSo) {
  EXPECT_EQ(value_words(objects::kErrorRegister, 0, false, nullptr), "no error");
  EXPECT_EQ(value_words(objects::kErrorRegister, 0x20, false, nullptr), "device profile");
}

}  // namespace
}  // namespace servoctl::show
