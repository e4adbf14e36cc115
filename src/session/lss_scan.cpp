// How a session finds LSS slaves: by walks through the tree of identities.
#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <utility>

#include "canopen/node_id.hpp"
#include "session/lss.hpp"

namespace servoctl::session {
namespace {

using canopen::LssAddress;
using canopen::LssFastscanStep;

constexpr Duration kConfirmation = std::chrono::milliseconds(100);
/// Slaves that are quick answer all within this time; where they are not, what comes later is taken for an
/// answer to the next step, and the walk fails.
constexpr Duration kHaste = std::chrono::milliseconds(10);
constexpr std::size_t kMostSlaves = 127;
constexpr std::uint8_t kTopBit = 31;
constexpr std::uint8_t kLastPart = 3;
constexpr std::uint32_t kBitsOfNumber = 32;
constexpr std::uint32_t kBitsOfIdentity = 128;

tl::unexpected<Error> lost_answer() {
  return fail(
      Errc::protocol, "an LSS slave answered to a part of the identities, and to neither half of it",
      "late or lost answers, or a slave that was switched off: `lss scan` again, with a longer --patience");
}

/// The walk is not repeated: patience does not help.
tl::unexpected<Error> answers_all() {
  return fail(Errc::negative, "an LSS slave answers to whatever identity is asked for",
              "switch one slave after the other off to find it");
}

/// Two vendor-IDs that are of no vendor.
constexpr std::array<std::uint32_t, 2> kNobody{0x5A3C'96E1, 0xA5C3'691E};

/// The end of the lower half of a range, and the beginning of the upper: by the revision, then by the serial
/// number.
std::pair<LssAddress, LssAddress> inner_ends(const LssAddress& low, const LssAddress& high) {
  const auto part = low.revision != high.revision ? &LssAddress::revision : &LssAddress::serial;
  auto end = high;
  end.*part = low.*part + (high.*part - low.*part) / 2;
  auto begin = low;
  begin.*part = end.*part + 1;
  return {end, begin};
}

/// Bits that are still open between two identities of one kind.
std::uint32_t open_bits(const LssAddress& low, const LssAddress& high) {
  return static_cast<std::uint32_t>(std::bit_width(high.revision - low.revision) +
                                    std::bit_width(high.serial - low.serial));
}

/// One walk of LSS fastscan: every identity that somebody without a node-ID has, in ascending order. Nobody
/// leaves the waiting state for it: the step that would select a slave is never sent.
class FastscanWalk {
 public:
  FastscanWalk(LssDialogue& lss, LssDialogue::Pace pace) : lss_(&lss), pace_(pace) {}

  Result<std::vector<LssFound>> run() {
    const auto any = probe({.number = 0, .bit = canopen::kFastscanBegin});
    if (!any) return fail(any.error());
    if (*any > 0)
      if (const auto done = walk_part(0); !done) return fail(done.error());
    return std::move(found_);
  }

 private:
  Result<std::size_t> probe(const LssFastscanStep& step) {
    return lss_->probe(canopen::lss_fastscan(step), pace_);
  }

  /// Those that fit the numbers before are asked for this one; both halves at least one of which is
  /// somebody's.
  Result<void> walk_part(std::uint8_t part) { return walk_halves(part, 0, kTopBit); }

  Result<void> walk_halves(std::uint8_t part, std::uint32_t number, std::uint8_t bit) {
    const auto low = walk(part, number, bit);
    if (!low) return fail(low.error());
    const auto high = walk(part, number | 1U << bit, bit);
    if (!high) return fail(high.error());
    return *low || *high ? Result<void>() : lost_answer();
  }

  /// Whether somebody has these bits of the number, from `bit` on upwards.
  Result<bool> walk(std::uint8_t part, std::uint32_t number, std::uint8_t bit) {
    lss_->tell({found_.size(), kBitsOfNumber * part + kTopBit - bit, kBitsOfIdentity});
    const auto answers = probe({number, bit, part, part});
    if (!answers) return fail(answers.error());
    if (*answers == 0) return false;
    const auto below = bit > 0 ? walk_halves(part, number, static_cast<std::uint8_t>(bit - 1))
                               : on_number(part, number, *answers);
    return below ? Result<bool>(true) : fail(below.error());
  }

  /// Who answers to everything seems to have the vendor-ID 0, and every other one.
  Result<void> doubt_zero() {
    std::size_t answered = 0;
    for (const auto vendor : kNobody) {
      const auto answers = probe({vendor, 0, 0, 0});
      if (!answers) return fail(answers.error());
      answered += *answers > 0 ? 1U : 0U;
    }
    return answered < kNobody.size() ? Result<void>() : answers_all();
  }

  Result<void> on_number(std::uint8_t part, std::uint32_t number, std::size_t answers) {
    if (part == 0 && number == 0)
      if (const auto good = doubt_zero(); !good) return good;
    numbers_[part] = number;
    if (part == kLastPart) {
      found_.push_back({{numbers_[0], numbers_[1], numbers_[2], numbers_[3]}, answers, {}});
      return found_.size() <= kMostSlaves ? Result<void>() : answers_all();
    }
    if (const auto moved = advance(part); !moved) return moved;
    if (const auto done = walk_part(static_cast<std::uint8_t>(part + 1)); !done) return done;
    return go_back_to(part);
  }

  /// Those that have the whole number are asked for the next one from now on.
  Result<void> advance(std::uint8_t part) {
    const auto moved = probe({numbers_[part], 0, part, static_cast<std::uint8_t>(part + 1)});
    if (!moved) return fail(moved.error());
    return *moved > 0 ? Result<void>() : lost_answer();
  }

  Result<void> go_back_to(std::uint8_t part) {
    const auto all = probe({.number = 0, .bit = canopen::kFastscanBegin});
    if (!all) return fail(all.error());
    for (std::uint8_t i = 0; i < part; ++i)
      if (const auto moved = advance(i); !moved) return moved;
    return {};
  }

  LssDialogue* lss_;
  LssDialogue::Pace pace_;
  std::array<std::uint32_t, 4> numbers_{};
  std::vector<LssFound> found_;
};

}  // namespace

std::array<LssDialogue::Pace, 3> LssDialogue::paces() const {
  // Each silence is waited for twice.
  const auto half = patience_ / 2;
  return {{{half, std::min(half, kHaste)}, {half, patience_}, {4 * patience_, 4 * patience_}}};
}

Result<std::size_t> LssDialogue::probe(const canopen::LssRequest& request, Pace pace) {
  for (int i = 0;; ++i) {
    const auto answers = ask(request, pace);
    if (!answers) return fail(answers.error());
    if (!answers->empty() || i == 1) return answers->size();
  }
}

Result<std::vector<LssFound>> LssDialogue::scan() {
  Error last;
  for (const auto pace : paces()) {
    if (const auto sent = send_to_waiting(); !sent) return fail(sent.error());
    again_ = last.code == Errc::protocol;
    auto found = FastscanWalk(*this, pace).run();
    const auto there = found ? confirm(*found) : fail(found.error());
    // Nobody, behind walks in which somebody answered, is no result.
    if (there && !(found->empty() && last.code == Errc::protocol)) return found;
    if (there) break;
    last = there.error();
    if (last.code != Errc::protocol) break;
  }
  return fail(std::move(last));
}

/// An answer that came late may have stood for another's: each is selected once, and says that it is there.
Result<void> LssDialogue::confirm(std::vector<LssFound>& found) {
  for (auto& each : found) {
    if (const auto sent = send_to_waiting(); !sent) return sent;
    const auto answers =
        ask(canopen::lss_select(each.address), {std::max(patience_, kConfirmation), kConfirmation});
    if (!answers) return fail(answers.error());
    if (answers->empty())
      return fail(
          Errc::protocol,
          "an LSS slave was found by fastscan and does not answer to its identity: " +
              to_string(each.address),
          "late answers, or a slave that was switched off: `lss scan` again, with a longer --patience");
    each.slaves = answers->size();
    if (each.slaves > 1) continue;
    const auto node = ask(canopen::lss_inquire(canopen::LssService::inquire_node), {patience_, kHaste});
    if (!node) return fail(node.error());
    const auto number = node->empty() ? canopen::kUnconfigured : node->front().number & 0xFFU;
    if (number >= canopen::kFirstNode && number <= canopen::kLastNode)
      each.node = static_cast<std::uint8_t>(number);
  }
  return found.empty() ? Result<void>() : send_to_waiting();
}

/// Whether somebody is there. A range in which somebody answers and in whose halves nobody does means that an
/// answer was lost.
Result<bool> LssDialogue::search_between(const LssAddress& low, const LssAddress& high, Pace pace,
                                         std::vector<LssAddress>& found) {
  tell({found.size(), kBitsOfIdentity - open_bits(low, high), kBitsOfIdentity});
  const auto answers = probe(canopen::lss_identify(low, high), pace);
  if (!answers) return fail(answers.error());
  if (*answers == 0) return false;
  if (low == high) {
    found.push_back(low);
    return found.size() <= kMostSlaves ? Result<bool>(true) : answers_all();
  }
  const auto [end, begin] = inner_ends(low, high);
  const auto first = search_between(low, end, pace, found);
  if (!first) return first;
  const auto second = search_between(begin, high, pace, found);
  if (!second || *first || *second) return second ? Result<bool>(true) : second;
  return lost_answer();
}

Result<std::vector<LssAddress>> LssDialogue::search(const LssAddress& low, const LssAddress& high) {
  Error last;
  for (const auto pace : paces()) {
    if (const auto sent = send_to_waiting(); !sent) return fail(sent.error());
    again_ = last.code == Errc::protocol;
    std::vector<LssAddress> out;
    const auto any = search_between(low, high, pace, out);
    if (any) return out;
    last = any.error();
    if (last.code != Errc::protocol) break;
  }
  return fail(std::move(last));
}

}  // namespace servoctl::session
