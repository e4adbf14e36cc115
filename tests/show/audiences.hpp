#pragma once

#include <string>
#include <string_view>

#include "show/audience.hpp"

/// People at the other side of a desk, for tests.
namespace servoctl::show {

/// Says yes to everything.
class Willing final : public Audience {
 public:
  Result<void> confirm(std::string_view /*question*/) override { return {}; }
};

/// Says no to everything.
class Unwilling final : public Audience {
 public:
  Result<void> confirm(std::string_view /*question*/) override { return fail(Errc::refused, "no"); }
};

}  // namespace servoctl::show
