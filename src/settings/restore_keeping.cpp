#include "settings/restore_keeping.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "session/pdo_change.hpp"
#include "session/storage.hpp"

namespace servoctl::settings {
namespace {

constexpr std::size_t kMostNames = 6;

std::string shown(const drive::Profile& profile, std::uint8_t node, ObjectAddress object,
                  const Bytes& bytes) {
  const auto meaning = drive::meaning(drive::target_at(&profile, object), node);
  const auto value = od::decode(meaning.type, bytes);
  return value ? drive::plain_text(meaning, *value) : to_hex(bytes);
}

/// What the drive's own start makes another value of.
void add_replaced(const drive::Profile& profile, std::uint8_t node, const Message& title,
                  const session::Values& wanted, std::vector<Message>& out) {
  auto all = wanted;
  session::add_stored_copies(profile, node, all);
  for (const auto& [place, copy] : all) {
    const auto own = wanted.find(place);
    const auto* parameter = profile.parameter(place);
    if ((own != wanted.end() && own->second == copy) || parameter == nullptr || !parameter->mirror) continue;
    const auto object = *parameter->mirror;
    const auto says = own == wanted.end()
                          ? Message("which is not written")
                          : message("which {} says is {}", title, shown(profile, node, place, own->second));
    out.push_back(message("node {}: {} is {} only until a restart: the drive then takes it from {}, {}",
                          node_name(node), to_string(object), shown(profile, node, object, wanted.at(object)),
                          as_it_is(parameter->id), says));
  }
}

}  // namespace

std::vector<Message> doubts_of_keeping(const drive::Profile& profile, std::uint8_t node, const Message& title,
                                       const session::Values& present, const session::Values& wanted) {
  std::vector<Message> out;
  if (!session::can_store(profile)) return out;
  NameList ids;
  std::size_t unknown = 0;
  for (const auto& [object, data] : wanted) {
    const auto now = present.find(object);
    const bool is_written = now == present.end() || now->second != data;
    if (!is_written || session::is_known_to_keep(profile, object)) continue;
    if (unknown++ < kMostNames) ids.words.push_back(to_string(object));
  }
  auto names = message("{}", ids);
  if (unknown > kMostNames) names += message(" and {} more", unknown - kMostNames);
  if (unknown > 0)
    out.push_back(message(
        "node {}: the manual does not say whether these survive power-off: {}; read them after a restart",
        node_name(node), names));
  add_replaced(profile, node, title, wanted, out);
  return out;
}

}  // namespace servoctl::settings
