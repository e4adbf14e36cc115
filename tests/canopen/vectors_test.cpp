// Frames printed in the drives' manuals (tests/vectors/*.txt) against client, server and decoders. They are
// outside evidence: our own client and server share code and could agree on the same mistake.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <filesystem>
#include <map>
#include <sstream>

#include "base/file.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/emergency.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_client.hpp"
#include "canopen/sdo_frame.hpp"
#include "canopen/sdo_server.hpp"
#include "tests/source_dir.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

struct Vector {
  std::string place;  ///< `ts.txt:123`
  std::string text;   ///< The frame as printed.
  bool to_drive = false;
  std::vector<std::string> meaning;  ///< Words behind `=`.
  bool misprinted = false;
};

std::vector<Vector> read_vectors(const std::filesystem::path& path) {
  std::vector<Vector> out;
  std::istringstream lines(read_file(path).value());
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.starts_with("> ") || line.starts_with("< "))
      out.push_back({fmt::format("{}:{}", path.filename().string(), number),
                     std::string(trim(line.substr(2, line.find(' ', 2) - 2))),
                     line[0] == '>',
                     {},
                     false});
    else if (line.starts_with("= "))
      for (const auto word : split(trim(std::string_view(line).substr(2)), ' '))
        out.back().meaning.emplace_back(word);
    else if (line.starts_with("!"))
      out.back().misprinted = true;
  }
  return out;
}

ObjectAddress object_of(const Vector& v) {
  const auto address = parse_object_address(v.meaning.at(1));
  EXPECT_TRUE(address) << v.place;
  return address.value_or(ObjectAddress{});
}

Bytes value_of(const Vector& v) {
  const std::map<std::string, std::size_t> sizes{{"i8", 1},  {"u8", 1},  {"i16", 2},
                                                 {"u16", 2}, {"i32", 4}, {"u32", 4}};
  const auto number = parse_integer(v.meaning.at(3));
  EXPECT_TRUE(number) << v.place;
  const auto raw = number->negative ? ~number->magnitude + 1 : number->magnitude;
  return store_le(raw, sizes.at(v.meaning.at(2)));
}

class VectorStore final : public ObjectStore {
 public:
  std::uint32_t read(ObjectAddress object, Bytes& out) override {
    last = object;
    out = value;
    return refusal;
  }
  std::uint32_t write(ObjectAddress object, ByteSpan data) override {
    last = object;
    value.assign(data.begin(), data.end());
    return refusal;
  }
  ObjectAddress last;
  Bytes value;
  std::uint32_t refusal = 0;
};

/// Bytes 4 to 7 are reserved in an acknowledge; some drives echo the data there.
std::string without_reserved(const std::string& text) { return text.substr(0, 12) + "00000000"; }

class Checker {
 public:
  void check(const Vector& v) {
    SCOPED_TRACE(v.place + " " + v.text);
    const auto parsed = can::parse_frame(v.text);
    ASSERT_TRUE(parsed);
    frame_ = *parsed;
    node_ = static_cast<std::uint8_t>(frame_.id & 0x7FU);
    const auto& word = v.meaning.at(0);
    if (word == "write") return check_write(v);
    if (word == "read") return check_read(v);
    if (word == "value") return check_value(v);
    if (word == "written") return check_written(v);
    if (word == "abort") return check_abort(v);
    if (word == "nmt") return check_nmt(v);
    if (word == "heartbeat" || word == "boot-up") return check_state(v);
    if (word == "emcy") return check_emergency(v);
    ASSERT_TRUE(word == "pdo" || word == "sync" || word == "guard") << "unknown word " << word;
    ++not_ours;
  }
  std::size_t checked = 0;
  std::size_t not_ours = 0;  ///< PDO, SYNC and guarding: no machine of ours decodes them yet.

 private:
  void check_write(const Vector& v) {
    VectorStore store;
    SdoServer server(node_, store, {});
    server.on_frame(frame_, TimePoint{});
    EXPECT_EQ(store.last, object_of(v));
    EXPECT_EQ(store.value, value_of(v));
    if (!v.misprinted) {
      SdoClient client(node_, std::chrono::seconds(1));
      client.start_download(object_of(v), value_of(v), TimePoint{});
      EXPECT_EQ(can::to_string(*client.take_frame()), v.text);
    }
    ++checked;
  }
  void check_read(const Vector& v) {
    SdoClient client(node_, std::chrono::seconds(1));
    client.start_upload(object_of(v), TimePoint{});
    EXPECT_EQ(can::to_string(*client.take_frame()), v.text);
    VectorStore store;
    SdoServer server(node_, store, {});
    server.on_frame(frame_, TimePoint{});
    EXPECT_EQ(store.last, object_of(v));
    ++checked;
  }
  void check_value(const Vector& v) {
    SdoClient client(node_, std::chrono::seconds(1));
    client.start_upload(object_of(v), TimePoint{});
    const auto request = client.take_frame();
    client.on_frame(frame_, TimePoint{});
    const auto result = client.take_result();
    ASSERT_TRUE(result && *result);
    EXPECT_EQ(**result, value_of(v));
    VectorStore store;
    store.value = value_of(v);
    SdoServer server(node_, store, {});
    server.on_frame(*request, TimePoint{});
    EXPECT_EQ(can::to_string(*server.take_frame()), v.text);
    ++checked;
  }
  void check_written(const Vector& v) {
    SdoClient client(node_, std::chrono::seconds(1));
    client.start_download(object_of(v), {0}, TimePoint{});
    const auto request = client.take_frame();
    client.on_frame(frame_, TimePoint{});
    const auto result = client.take_result();
    ASSERT_TRUE(result);
    EXPECT_TRUE(*result);
    VectorStore store;
    SdoServer server(node_, store, {});
    server.on_frame(*request, TimePoint{});
    EXPECT_EQ(can::to_string(*server.take_frame()), without_reserved(v.text));
    ++checked;
  }
  void check_abort(const Vector& v) {
    const auto code = static_cast<std::uint32_t>(parse_integer(v.meaning.at(2))->magnitude);
    SdoClient client(node_, std::chrono::seconds(1));
    client.start_upload(object_of(v), TimePoint{});
    const auto request = client.take_frame();
    client.on_frame(frame_, TimePoint{});
    const auto result = client.take_result();
    ASSERT_TRUE(result && !*result);
    EXPECT_EQ(result->error().abort_code, code);
    VectorStore store;
    store.refusal = code;
    SdoServer server(node_, store, {});
    server.on_frame(*request, TimePoint{});
    EXPECT_EQ(can::to_string(*server.take_frame()), v.text);
    ++checked;
  }
  void check_nmt(const Vector& v) {
    const auto command = parse_nmt_command(v.meaning.at(1));
    ASSERT_TRUE(command);
    const auto node = static_cast<std::uint8_t>(parse_digits(v.meaning.at(2), 10).value());
    EXPECT_EQ(can::to_string(nmt_frame(*command, node)), v.text);
    ASSERT_TRUE(parse_nmt(frame_));
    EXPECT_EQ(parse_nmt(frame_)->command, *command);
    EXPECT_EQ(parse_nmt(frame_)->node, node);
    ++checked;
  }
  void check_state(const Vector& v) {
    const auto message = parse_error_control(frame_);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->node, parse_digits(v.meaning.at(1), 10));
    EXPECT_EQ(name(message->state), v.meaning.at(0) == "boot-up" ? "boot-up" : v.meaning.at(2));
    EXPECT_EQ(can::to_string(heartbeat_frame(message->node, message->state)), v.text);
    ++checked;
  }
  void check_emergency(const Vector& v) {
    const auto emergency = parse_emergency(frame_);
    ASSERT_TRUE(emergency);
    EXPECT_EQ(emergency->node, parse_digits(v.meaning.at(1), 10));
    EXPECT_EQ(emergency->code, parse_integer(v.meaning.at(2))->magnitude);
    EXPECT_EQ(can::to_string(emergency_frame(*emergency)), v.text);
    ++checked;
  }

  can::Frame frame_;
  std::uint8_t node_ = 0;
};

void check_file(const char* name, std::size_t frames, std::size_t not_ours) {
  Checker checker;
  const auto vectors = read_vectors(std::filesystem::path(source_dir()) / "tests/vectors" / name);
  EXPECT_EQ(vectors.size(), frames);
  for (const auto& v : vectors) {
    ASSERT_FALSE(v.meaning.empty()) << v.place << " has no '=' line";
    checker.check(v);
  }
  EXPECT_EQ(checker.not_ours, not_ours);
  EXPECT_EQ(checker.checked + checker.not_ours, frames);
}

TEST(PrintedFrames, OfTheGsd600ManualAreSentAndUnderstood) { check_file("gsd600.txt", 18, 2); }
TEST(PrintedFrames, OfTheTsManualAreSentAndUnderstood) { check_file("ts.txt", 129, 8); }

}  // namespace
}  // namespace servoctl::canopen
