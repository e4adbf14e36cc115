// The Chinese that comes with the program.
#include "report/zh_po.hpp"

#include <gtest/gtest.h>

#include <cctype>

#include "report/catalogue.hpp"

namespace servoctl::report {
namespace {

/// What the test puts into a place: a number where one belongs, else a word that is in no catalogue.
std::vector<std::string> samples_of(const Phrase& phrase) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < phrase.places().size(); ++i) {
    const auto& place = phrase.places()[i];
    out.resize(std::max(out.size(), place.argument + 1));
    const bool beside = i > 0 && phrase.pieces()[i].empty();
    out[place.argument] =
        beside || (place.suffix && !place.number) ? "" : std::to_string(17 + place.argument);
  }
  return out;
}

TEST(ZhPo, IsReadAsAWhole) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries) << entries.error().message;
  EXPECT_GT(entries->size(), 2000U);
}

/// What is put together with other texts is taken apart again: what stands at its ends does not count.
std::string core(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bool skipped = false;
    for (const std::string_view mark : {"，", "；", "：", "。", "（", "）", "？", "、"})
      if (text.substr(i).starts_with(mark)) {
        i += mark.size() - 1;
        skipped = true;
        break;
      }
    if (!skipped && std::string_view(" ,;:.()?\n").find(text[i]) == std::string_view::npos) out += text[i];
  }
  return out;
}

TEST(ZhPo, EveryEntryIsFoundByTheTextsThatAreMadeWithIt) {
  const auto entries = parse_po(zh_po(), "zh.po");
  ASSERT_TRUE(entries);
  std::size_t wrong = 0;
  for (const auto& entry : *entries) {
    if (entry.text.empty()) continue;
    const Phrase id(entry.id);
    if (!id.places().empty() && (id.letters() < 3 || id.words().empty())) continue;
    const auto samples = samples_of(id);
    const auto text = id.with(samples);
    const auto wanted = Phrase(entry.text).with(samples);
    const auto said = in_chinese(text);
    if (core(said) == core(wanted)) continue;
    ++wrong;
    ADD_FAILURE() << "line " << entry.line << ": " << text << "\n  is      " << said << "\n  and not "
                  << wanted;
  }
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace servoctl::report
