#pragma once

#include <memory>
#include <utility>

#include "command/context.hpp"
#include "drive/shared_profile.hpp"

namespace servoctl::command {

/// While it lives the desk knows what CiA 301 and 402 say of objects, if their data can be read, whether a
/// family was named or not.
class StandardScope {
 public:
  explicit StandardScope(Context& context) : context_(&context), before_(context.standard) {
    if (before_ != nullptr) return;
    auto loaded = drive::shared_profile(drive::kGenericFamily, context.drive_folders);
    if (loaded) held_ = std::move(*loaded);
    context.standard = held_.get();
  }
  StandardScope(const StandardScope&) = delete;
  StandardScope& operator=(const StandardScope&) = delete;
  ~StandardScope() { context_->standard = before_; }

 private:
  Context* context_;
  const drive::Profile* before_;
  std::shared_ptr<const drive::Profile> held_;
};

}  // namespace servoctl::command
