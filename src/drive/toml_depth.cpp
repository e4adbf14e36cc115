#include "drive/toml_depth.hpp"

#include <fmt/format.h>
#include <cctype>

namespace servoctl::drive {
namespace {

constexpr std::size_t kDeepest = 64;

/// Counts without knowing what is quoted and what a comment: text that looks as deep as that is none of ours
/// either.
class Depth {
 public:
  void take(char c) {
    if (c == '[' || c == '{')
      ++brackets_;
    else if ((c == ']' || c == '}') && brackets_ > 0)
      --brackets_;
    const bool blank = c == ' ' || c == '\t';
    const bool key = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '"' ||
                     c == '\'' || static_cast<unsigned char>(c) >= 0x80;
    if (c == '.' && !after_dot_)
      ++dots_;
    else if (!blank && !key)
      dots_ = 0;
    after_dot_ = c == '.' || (blank && after_dot_);
  }
  bool too_deep() const { return brackets_ > kDeepest || dots_ > kDeepest; }

 private:
  std::size_t brackets_ = 0;
  std::size_t dots_ = 0;  ///< Of one dotted key.
  bool after_dot_ = false;
};

}  // namespace

Result<void> check_toml_depth(std::string_view toml, std::string_view file) {
  Depth depth;
  std::uint32_t line = 1;
  for (const char c : toml) {
    line += c == '\n' ? 1 : 0;
    depth.take(c);
    if (!depth.too_deep()) continue;
    auto error =
        fail(Errc::file, fmt::format("{}:{}: tables are nested deeper than {} levels", file, line, kDeepest))
            .value();
    error.line = line;
    return fail(std::move(error));
  }
  return {};
}

}  // namespace servoctl::drive
