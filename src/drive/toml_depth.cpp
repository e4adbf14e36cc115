#include "drive/toml_depth.hpp"

#include <algorithm>
#include <cctype>

#include "base/format.hpp"

namespace servoctl::drive {
namespace {

constexpr std::size_t kDeepest = 64;

/// Goes through TOML as far as it is valid: toml++ reads no further either. Brackets and dots in strings and
/// comments nest nothing.
class Depth {
 public:
  explicit Depth(std::string_view toml) : toml_(toml) {}

  bool is_at_end() const { return at_ >= toml_.size(); }
  /// Takes a string or a comment as a whole, else one character.
  void step() {
    const char c = toml_[at_];
    if (c == '"' || c == '\'') {
      at_ = end_of_string(c);
      after_dot_ = false;  // It may be a part of a dotted key.
    } else if (c == '#') {
      at_ = std::min(toml_.find('\n', at_), toml_.size());
    } else {
      take(c);
      ++at_;
    }
  }
  bool is_too_deep() const { return brackets_ > kDeepest || dots_ > kDeepest; }
  auto line() const { return 1 + std::count(toml_.begin(), toml_.begin() + static_cast<long>(at_), '\n'); }

 private:
  void take(char c) {
    if (c == '[' || c == '{')
      ++brackets_;
    else if ((c == ']' || c == '}') && brackets_ > 0)
      --brackets_;
    const bool blank = c == ' ' || c == '\t';
    const bool key = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ||
                     static_cast<unsigned char>(c) >= 0x80;
    if (c == '.' && !after_dot_)
      ++dots_;
    else if (!blank && !key)
      dots_ = 0;
    after_dot_ = c == '.' || (blank && after_dot_);
  }

  std::size_t quotes_at(std::size_t at, char quote, std::size_t most) const {
    std::size_t count = 0;
    while (count < most && at + count < toml_.size() && toml_[at + count] == quote) ++count;
    return count;
  }

  /// Behind the string that begins here. In one of several lines up to two quotes may stand before the three
  /// that end it; one of a single line ends with the line at the latest.
  std::size_t end_of_string(char quote) const {
    const auto opening = quotes_at(at_, quote, 3);
    if (opening == 2) return at_ + 2;
    const bool lines = opening == 3;
    for (auto at = at_ + opening; at < toml_.size();) {
      const auto quotes = quotes_at(at, quote, lines ? 5 : 1);
      if (quotes >= opening) return at + quotes;
      if (toml_[at] == '\n' && !lines) return at;
      at += quotes > 0 ? quotes : toml_[at] == '\\' && quote == '"' ? 2 : 1;
    }
    return toml_.size();
  }

  std::string_view toml_;
  std::size_t at_ = 0;
  std::size_t brackets_ = 0;
  std::size_t dots_ = 0;  ///< Of one dotted key.
  bool after_dot_ = false;
};

}  // namespace

Result<void> check_toml_depth(std::string_view toml, std::string_view file) {
  Depth depth(toml);
  while (!depth.is_at_end()) {
    depth.step();
    if (!depth.is_too_deep()) continue;
    const auto line = static_cast<std::uint32_t>(depth.line());
    auto error = fail(Errc::file, message("{}:{}: tables are nested deeper than {} levels", as_it_is(file),
                                          line, kDeepest))
                     .value();
    error.line = line;
    return fail(std::move(error));
  }
  return {};
}

}  // namespace servoctl::drive
