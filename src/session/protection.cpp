#include "session/protection.hpp"

namespace servoctl::session {

Care Protection::worst() const {
  for (const auto care : {Care::guarded, Care::energised})
    if (held_[static_cast<std::size_t>(care)] > 0) return care;
  return Care::none;
}

void Protection::add(Care care) {
  const auto before = worst();
  ++held_[static_cast<std::size_t>(care)];
  tell(before);
}

void Protection::remove(Care care) {
  const auto before = worst();
  --held_[static_cast<std::size_t>(care)];
  tell(before);
}

void Protection::tell(Care before) const {
  if (on_change_ && worst() != before) on_change_(worst());
}

void EnergisedNodes::insert(std::uint8_t node) {
  if (nodes_.empty()) hold_ = Protection::Hold(protection_, Care::energised);
  nodes_.insert(node);
}

void EnergisedNodes::erase(std::uint8_t node) {
  if (nodes_.erase(node) > 0 && nodes_.empty()) hold_.release();
}

}  // namespace servoctl::session
