#include "cli/terminal/prompt_notices.hpp"

#include <utility>

#include "base/format.hpp"

namespace servoctl::cli {
namespace {

/// Notices that are kept for a terminal that takes nothing.
constexpr std::size_t kMost = 100;

}  // namespace

void PromptNotices::hear(Shell& shell) {
  const auto& settings = shell.defaults();
  const auto loaded =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : shell.profile(settings.drive);
  for (auto& notice : shell.take_notices(loaded ? *loaded : nullptr, settings.chinese)) {
    if (waiting_.size() < kMost)
      waiting_.push_back(std::move(notice));
    else
      ++left_out_;
  }
}

std::vector<Message> PromptNotices::give() {
  if (left_out_ > 0)
    waiting_.push_back(
        message("{} messages were not shown: the output was not read in time", std::exchange(left_out_, 0)));
  return std::exchange(waiting_, {});
}

}  // namespace servoctl::cli
