// Whatever text a drive holds is a value in every format, and nothing else.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <random>

#include "tests/cli/backup_world.hpp"

namespace servoctl::cli {
namespace {

/// Text as it would hurt: each piece with a meaning to somebody who reads a line.
std::string any_text(std::mt19937& random) {
  static const std::vector<std::string> kPieces = {"--from=/etc/passwd",
                                                   "--yes",
                                                   "-h",
                                                   "--help",
                                                   "--",
                                                   "-",
                                                   "\"",
                                                   "'",
                                                   "\\",
                                                   "#",
                                                   "${A}",
                                                   "$",
                                                   "\n",
                                                   "\r",
                                                   "\n6040h 15",
                                                   " ",
                                                   "\t",
                                                   "=",
                                                   "=1+1",
                                                   "@",
                                                   "+",
                                                   "hex:00",
                                                   "\x1b[2J",
                                                   "\xC2\x9B",
                                                   "\xE2\x80\xAE",
                                                   "\xFF",
                                                   "\xE6\x8C\xAF",
                                                   "a",
                                                   "1",
                                                   "0x10",
                                                   ";",
                                                   "[1017]",
                                                   ",",
                                                   std::string(1, '\0'),
                                                   "end",
                                                   "use 2",
                                                   "\x7F"};
  std::string out;
  for (auto left = random() % 6; left > 0; --left) out += kPieces[random() % kPieces.size()];
  return out;
}

TEST(AnyText, SurvivesEveryFormatAndIsNothingButAValue) {
  std::mt19937 random(15);
  for (int round = 0; round < 600; ++round) {
    const auto text = any_text(random);
    SCOPED_TRACE(fmt::format("round {}: {}", round, to_hex(Bytes(text.begin(), text.end()))));
    const Bytes bytes(text.begin(), text.end());
    const ObjectAddress object{0x2000, 0};
    World source("lab", {{object, bytes}});
    ASSERT_EQ(source.drive().value(object), bytes);
    auto backup = source.backup();
    std::erase_if(backup.entries, [&](const auto& entry) { return entry.object != object; });
    World target("lab", {{object, Bytes{'o', 'l', 'd'}}});
    for (const auto format :
         {BackupFormat::json, BackupFormat::csv, BackupFormat::batch, BackupFormat::dcf}) {
      SCOPED_TRACE(static_cast<int>(format));
      const auto written = target.text(backup, format);
      ASSERT_TRUE(written) << written.error().message.text();
      const auto read = target.read(*written, format);
      if (format == BackupFormat::dcf && !read)
        continue;  // Nothing of it could stand there, and that is told.
      ASSERT_TRUE(read) << read.error().message.text() << "\n" << *written;
      for (const auto& entry : read->entries) {
        ASSERT_TRUE(format == BackupFormat::dcf || entry.object == object) << to_string(entry.object);
        if (entry.object == object && entry.bytes) {
          ASSERT_EQ(*entry.bytes, bytes) << *written;
        }
      }
    }
    const auto read = target.read(target.text(backup, BackupFormat::json).value(), BackupFormat::json);
    const auto done = target.restore(read.value());
    ASSERT_TRUE(done) << done.error().message.text();
    EXPECT_TRUE(target.context.errors.empty()) << target.context.errors.front().message.text();
    EXPECT_EQ(target.drive().value(object), bytes);
  }
}

RC_GTEST_PROP(AnyText, InALineIsOneValueOfOneWriteAndNoOption,
              (const std::string& before, std::uint32_t seed)) {
  std::mt19937 random(seed);
  const auto text = before + any_text(random);
  const Bytes bytes(text.begin(), text.end());
  const auto line = settings::commented_line(&profile_of("lab"), 1, {0x2000, 0}, bytes);
  const auto batch = parse_batch(line + "\nread 0x1000\n");
  RC_ASSERT(batch.errors.empty());
  RC_ASSERT(batch.statements.size() == 2U);
  const auto words = split_words(batch.statements.front().text).value();
  const auto first = parse_line(words).value();
  RC_ASSERT(first.command->path == "write");
  for (const auto* option : {"--from", "--keep", "--unlock", "--yes", "--trace", "--bus"})
    RC_ASSERT(!first.arguments.has(option));
  const auto target = drive::resolve(&profile_of("lab"), first.arguments.text("object")).value();
  RC_ASSERT(target.address == (ObjectAddress{0x2000, 0}));
  const auto meaning = drive::meaning(target, 1);
  const auto value = drive::parse_quantity(meaning, first.arguments.text("value")).value();
  RC_ASSERT(od::encode(meaning.type, value).value() == bytes);
}

}  // namespace
}  // namespace servoctl::cli
