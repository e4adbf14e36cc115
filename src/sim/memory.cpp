#include "sim/memory.hpp"

#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::sim {
namespace {

constexpr std::string_view kHeader = "# servoctl: memory of simulated drives, version 1";

}  // namespace

Result<Memory> Memory::open(const std::filesystem::path& file) {
  Memory memory;
  memory.file_ = file;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    if (const auto saved = memory.save(); !saved) return fail(saved.error());
    return memory;
  }
  const auto text = read_file(file);
  if (!text) return fail(text.error());
  if (const auto parsed = memory.parse(*text); !parsed) return fail(parsed.error());
  return memory;
}

Result<void> Memory::parse(std::string_view text) {
  std::uint32_t number = 0;
  for (const auto line : split(text, '\n')) {
    ++number;
    if (number == 1 && line != kHeader)
      return fail(Errc::file, message("{}: not a memory of simulated drives", as_it_is(file_.string())),
                  "name a file that does not exist yet");
    if (line.empty() || line.front() == '#') continue;
    const auto words = split(line, ' ');
    const auto object = words.size() == 3 ? parse_object_address(words[1]) : std::nullopt;
    const auto bytes = words.size() == 3 ? parse_hex_bytes(words[2]) : std::nullopt;
    if (!object || !bytes)
      return fail(
          Errc::file,
          message("{}:{}: expected a drive, an object and its bytes", as_it_is(file_.string()), number),
          "correct the line or delete the file");
    drives_[std::string(words[0])][*object] = *bytes;
  }
  return {};
}

Result<void> Memory::save() const {
  if (file_.empty()) return {};
  std::string text = std::string(kHeader) + "\n";
  for (const auto& drive : drives_)
    for (const auto& cell : drive.second)
      text += formatted("{} {} {}\n", drive.first, to_string(cell.first), to_hex(cell.second, ""));
  return write_file_atomically(file_, text);
}

}  // namespace servoctl::sim
