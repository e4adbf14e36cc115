#include "od/code_page.hpp"

#include <gtest/gtest.h>
#include <iconv.h>

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "base/utf8.hpp"
#include "od/text_encoding.hpp"

namespace servoctl::od {
namespace {

/// The system's own converter, with which the tables are compared.
class Iconv {
 public:
  explicit Iconv(std::string_view encoding) : open_(::iconv_open("UTF-8", std::string(encoding).c_str())) {}
  Iconv(const Iconv&) = delete;
  Iconv& operator=(const Iconv&) = delete;
  ~Iconv() {
    if (works()) ::iconv_close(open_);
  }

  bool works() const { return open_ != reinterpret_cast<iconv_t>(-1); }

  /// The text in UTF-8; nothing where a byte of it means nothing.
  std::optional<std::string> text(std::string bytes) {
    std::string out(bytes.size() * 3 + 4, '\0');
    auto* from = bytes.data();
    auto* to = out.data();
    std::size_t left = bytes.size();
    std::size_t room = out.size();
    ::iconv(open_, nullptr, nullptr, nullptr, nullptr);
    if (::iconv(open_, &from, &left, &to, &room) == static_cast<std::size_t>(-1) || left > 0) return {};
    out.resize(out.size() - room);
    return out;
  }

 private:
  iconv_t open_;
};

constexpr std::array kPages = {TextEncoding::gbk,   TextEncoding::cp1252, TextEncoding::cp850,
                               TextEncoding::cp932, TextEncoding::cp950,  TextEncoding::cp1251};
constexpr std::array kAll = {TextEncoding::utf8,  TextEncoding::utf16le, TextEncoding::utf16be,
                             TextEncoding::gbk,   TextEncoding::cp1252,  TextEncoding::cp850,
                             TextEncoding::cp932, TextEncoding::cp950,   TextEncoding::cp1251};

std::optional<std::string> ours(const std::string& bytes, TextEncoding encoding) {
  std::string out;
  for (std::string_view rest = bytes; !rest.empty();) {
    const auto character = CodePage::of(encoding).first(rest);
    if (!character.value) return {};
    append_utf8(*character.value, out);
    rest.remove_prefix(character.size);
  }
  return out;
}

TEST(CodePages, HaveEveryCharacterThatTheSystemHas) {
  for (const auto encoding : kPages) {
    Iconv system(name(encoding));
    if (!system.works()) GTEST_SKIP() << "this system has no " << name(encoding);
    for (int first = 0; first < 256; ++first) {
      const std::string one(1, static_cast<char>(first));
      EXPECT_EQ(ours(one, encoding), system.text(one)) << name(encoding) << ' ' << first;
      for (int last = 0; last < 256; ++last) {
        const auto two = one + static_cast<char>(last);
        ASSERT_EQ(ours(two, encoding), system.text(two)) << name(encoding) << ' ' << first << ' ' << last;
      }
    }
  }
}

TEST(CodePages, ReadAnyBytesAsTheSystemDoes) {
  std::mt19937 random(1);
  for (const auto encoding : kAll) {
    Iconv system(name(encoding));
    if (!system.works()) GTEST_SKIP() << "this system has no " << name(encoding);
    for (int i = 0; i < 2'000; ++i) {
      std::string bytes(2 * (1 + random() % 4), '\0');
      for (auto& byte : bytes) byte = static_cast<char>(random() % 3 == 0 ? random() % 128 : random());
      if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) continue;
      const auto theirs = system.text(bytes);
      EXPECT_EQ(means_something(bytes, encoding), theirs.has_value()) << name(encoding) << ' ' << bytes;
      if (theirs && theirs->find('\0') == std::string::npos && !theirs->starts_with("\xEF\xBB\xBF")) {
        EXPECT_EQ(std::string(to_utf8(bytes, encoding).text(bytes)), *theirs) << name(encoding);
      }
    }
  }
}

}  // namespace
}  // namespace servoctl::od
