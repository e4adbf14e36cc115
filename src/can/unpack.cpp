#include "can/unpack.hpp"

#define ZLIB_CONST
#include <zlib.h>

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
  // Grows as it comes: what is said to be large may be small.
  std::string step(kStep, '\0');
  while (state == Z_OK && bytes.size() <= most) {
    stream.next_out = reinterpret_cast<Bytef*>(step.data());
    stream.avail_out = static_cast<uInt>(step.size());
    state = ::inflate(&stream, Z_NO_FLUSH);
    bytes.append(step, 0, step.size() - stream.avail_out);
  }
  ::inflateEnd(&stream);
  out.whole = state == Z_STREAM_END && bytes.size() <= most;
  if (bytes.size() > most) bytes.erase(most);
  return out;
}

}  // namespace servoctl::can
