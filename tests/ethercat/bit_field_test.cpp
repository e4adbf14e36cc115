#include "ethercat/bit_field.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace servoctl::ethercat {
namespace {

RC_GTEST_PROP(BitField, WhatIsWrittenIsReadAndNothingElseChanges, ()) {
  const auto at = *rc::gen::inRange<std::size_t>(0, 40);
  const auto bits = *rc::gen::inRange<std::size_t>(0, 33);
  const auto value = *rc::gen::container<Bytes>((bits + 7) / 8, rc::gen::arbitrary<std::uint8_t>());
  const auto before = *rc::gen::container<Bytes>(10, rc::gen::arbitrary<std::uint8_t>());
  auto image = before;
  write_bits(image, at, bits, value);
  Bytes read((bits + 7) / 8);
  read_bits(image, at, bits, read);
  for (std::size_t i = 0; i < 80; ++i) {
    const auto bit = [&](const Bytes& bytes, std::size_t n) { return bytes[n / 8] >> n % 8 & 1; };
    const bool inside = i >= at && i < at + bits;
    RC_ASSERT(bit(image, i) == (inside ? bit(value, i - at) : bit(before, i)));
    if (inside) RC_ASSERT(bit(read, i - at) == bit(value, i - at));
  }
  if (bits % 8 != 0) RC_ASSERT((read.back() >> bits % 8) == 0);
}

}  // namespace
}  // namespace servoctl::ethercat
