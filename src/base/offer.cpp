#include "base/offer.hpp"

#include "base/text.hpp"

namespace servoctl {

Message did_you_mean(std::string_view text, std::span<const std::string> candidates) {
  const auto best = nearest(text, candidates);
  switch (best.size()) {
    case 0: return {};
    case 1: return message("did you mean {}?", as_it_is(best[0]));
    case 2: return message("did you mean {} or {}?", as_it_is(best[0]), as_it_is(best[1]));
    default:
      return message("did you mean {}, {} or {}?", as_it_is(best[0]), as_it_is(best[1]), as_it_is(best[2]));
  }
}

Message one_of(std::span<const std::string> words) {
  if (words.empty()) return {};
  if (words.size() == 1) return as_it_is(words.front());
  const auto first = words.first(words.size() - 1);
  return message("{} or {}", NameList{{first.begin(), first.end()}}, as_it_is(words.back()));
}

}  // namespace servoctl
