// Files of PDOs; the first byte chooses .toml or .json. What is read is followed by a drive with its PDOs as
// from the factory, or refused in words.
#include <filesystem>
#include <set>

#include "pdo/pdo_recipes.hpp"
#include "session/pdo_setup.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/source_dir.hpp"

using namespace servoctl;

namespace {

constexpr std::uint8_t kNode = 1;

const drive::Profile& profile() {
  static const auto loaded = drive::load_profile("gsd600", kFolders).value();
  return loaded;
}

const pdo::PresentPdos& present() {
  static const pdo::PresentPdos out = [] {
    auto values = session::default_pdo_values(profile(), kNode);
    auto pdos = session::pdos_of(values);
    return pdo::PresentPdos{kNode, std::move(values), std::move(pdos)};
  }();
  return out;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto* name = data[0] % 2 == 0 ? "fuzz.toml" : "fuzz.json";
  const auto file = pdo::parse_pdo_file(fuzz::text(data + 1, size - 1), name);
  if (!file) {
    fuzz::require(file.error().code == Errc::file, "a file that cannot be read is Errc::file");
    fuzz::require(file.error().message.text().starts_with(name), "… and says which file");
    return 0;
  }
  const auto wanted = pdo::follow(profile(), present(), file->pdos);
  if (!wanted) {
    fuzz::require(!wanted.error().message.text().empty(), "what cannot be followed is refused in words");
    return 0;
  }
  std::set<std::uint16_t> seen;
  for (const auto& pdo : wanted->pdos) {
    fuzz::require(present().find(pdo) != nullptr, "only PDOs the drive has are changed");
    fuzz::require(seen.insert(pdo.communication_index()).second, "none is changed twice");
    fuzz::require((pdo.cob_id & canopen::kPdoCobIdMask) <= 0x7FF, "a CAN-ID has 11 bits");
  }
  return 0;
}
