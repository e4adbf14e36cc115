#include "can/unpack.hpp"

#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>

namespace servoctl::can {

Unpacked unpack(std::string_view packed, std::size_t most) {
  Unpacked out;
  z_stream stream{};
  if (::inflateInit(&stream) != Z_OK) return out;
  stream.next_in = reinterpret_cast<const Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  constexpr std::size_t kStep = std::size_t{64} << 10U;
  auto& bytes = out.bytes;
  int state = Z_OK;
  // Grows as it comes: what is said to be large may be small. One byte beyond the limit shows that there is
  // more.
  while (state == Z_OK && bytes.size() <= most) {
    const auto size = bytes.size();
    bytes.resize(std::min(most + 1, size + kStep));
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + size);
    stream.avail_out = static_cast<uInt>(bytes.size() - size);
    state = ::inflate(&stream, Z_NO_FLUSH);
    bytes.resize(bytes.size() - stream.avail_out);
  }
  ::inflateEnd(&stream);
  out.whole = state == Z_STREAM_END && bytes.size() <= most;
  bytes.resize(std::min(bytes.size(), most));
  return out;
}

}  // namespace servoctl::can
