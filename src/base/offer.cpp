#include "base/offer.hpp"

#include "base/text.hpp"

namespace servoctl {

Message did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const auto best = nearest(text, candidates);
  return best.empty() ? Message() : message("did you mean {}?", one_of(best));
}

Message one_of(std::span<const std::string> words) {
  if (words.empty()) return {};
  if (words.size() == 1) return as_it_is(words[0]);
  if (words.size() == 2) return message("{} or {}", as_it_is(words[0]), as_it_is(words[1]));
  return message("{}, {}", as_it_is(words[0]), one_of(words.subspan(1)));
}

}  // namespace servoctl
