#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "canopen/sdo_server.hpp"

namespace servoctl::canopen {

/// 1, 2, 3, … 255, 0, 1 …
inline Bytes counted(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i + 1);
  return out;
}

inline Bytes text(std::string_view words) { return {words.begin(), words.end()}; }

/// A server's dictionary with one object, that refuses when it is told to.
class OneObject final : public ObjectStore {
 public:
  std::uint32_t read(ObjectAddress, Bytes& out) override {
    out = value;
    return refusal;
  }
  std::uint32_t write(ObjectAddress, ByteSpan data) override {
    if (refusal == 0) value.assign(data.begin(), data.end());
    writes += refusal == 0;
    return refusal;
  }
  Bytes value;
  std::uint32_t refusal = 0;
  int writes = 0;
};

}  // namespace servoctl::canopen
