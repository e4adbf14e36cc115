#include "session/protection.hpp"

namespace servoctl::session {

Care Protection::highest() const {
  for (const auto care : {Care::guarded, Care::energised, Care::unsettled})
    if (held_[static_cast<std::size_t>(care)] > 0) return care;
  return Care::none;
}

Care Protection::worst() const {
  const std::lock_guard lock(mutex_);
  return highest();
}

void Protection::add(Care care) {
  const std::lock_guard lock(mutex_);
  const auto before = highest();
  ++held_[static_cast<std::size_t>(care)];
  tell(before);
}

void Protection::remove(Care care) {
  const std::lock_guard lock(mutex_);
  const auto before = highest();
  --held_[static_cast<std::size_t>(care)];
  tell(before);
}

void Protection::tell(Care before) const {
  if (on_change_ && highest() != before) on_change_(highest());
}

void EnergisedNodes::insert(std::uint8_t node) {
  if (nodes_.empty()) hold_ = Protection::Hold(protection_, Care::energised);
  nodes_.insert(node);
}

void EnergisedNodes::erase(std::uint8_t node) {
  if (nodes_.erase(node) > 0 && nodes_.empty()) hold_.release();
}

}  // namespace servoctl::session
