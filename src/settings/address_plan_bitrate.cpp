#include "settings/address_plan_bitrate.hpp"

#include <algorithm>
#include <utility>

#include "settings/address_resume.hpp"

namespace servoctl::settings {

Result<void> PlanBitrate::look(std::span<const AddressChange> changes, std::uint32_t bitrate) {
  follower_.bitrate = bitrate;
  if (!options_->follower) return {};
  auto follower = options_->follower(changes, bitrate);
  if (!follower) return fail(follower.error());
  follower_ = std::move(*follower);
  return {};
}

std::string PlanBitrate::then() const {
  if (!follower_.follows()) return {};
  const auto who = options_->beside ? options_->beside(follower_) : std::string();
  return switch_text(follower_) + (who.empty() ? who : "; " + who);
}

void PlanBitrate::tell_commands() const {
  if (follower_.follows()) desk_->notices.push_back("then " + switch_commands(follower_));
}

void PlanBitrate::add(std::size_t row, AddressChange change, AddressOutcome outcome) {
  rows_.push_back(row);
  changes_.push_back(std::move(change));
  outcomes_.push_back(std::move(outcome));
}

bool PlanBitrate::is_still_so() {
  if (const auto again = look(changes_, follower_.bitrate); !again) {
    desk_->errors.push_back(again.error());
    return false;
  }
  return true;
}

bool PlanBitrate::end(std::span<const AddressRow> rows,
                      const std::function<void(std::size_t row, std::string_view)>& note) {
  if (changes_.empty()) return true;
  // The moves took their time: somebody may have been enabled, or have come, who is not to be restarted.
  if (follower_.follows() && !is_still_so()) return false;
  bool all = true;
  if (follower_.follows()) {
    follow_bitrate(*desk_, follower_, changes_, outcomes_, options_->each);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto& outcome = outcomes_[i];
      if (outcome.end != AddressEnd::awaits_restart) note(rows_[i], text_of(outcome.end));
      if (outcome.error) desk_->errors.push_back(with_row(rows[rows_[i]], *outcome.error));
      all = all && !outcome.error;
    }
  }
  const bool is_there = follower_.link != nullptr && follower_.before.bitrate == follower_.bitrate;
  const bool by_hand = std::ranges::any_of(outcomes_, [&](const AddressOutcome& outcome) {
    return outcome.end == AddressEnd::awaits_restart ||
           (outcome.end == AddressEnd::nothing_to_do && !is_there);
  });
  if (by_hand) tell_bitrate_by_hand(*desk_, follower_, changes_);
  return all;
}

}  // namespace servoctl::settings
