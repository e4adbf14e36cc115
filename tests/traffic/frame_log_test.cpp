// What `decode` and `monitor` write for programs.
#include "traffic/frame_log.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/text.hpp"
#include "od/eds.hpp"

namespace servoctl::traffic {
namespace {

/// Objects whose names would break JSON that is written without care.
constexpr std::string_view kHostileEds =
    "[MandatoryObjects]\nSupportedObjects=1\n1=0x1008\n[OptionalObjects]\nSupportedObjects=2\n1=0x6041\n2="
    "0x6064\n"
    "[1008]\nParameterName=Device \"name\"\nObjectType=0x7\nDataType=0x0009\nAccessType=const\n"
    "[6041]\nParameterName=Status \"word\" \\ \x01 {[:,\nObjectType=0x7\nDataType=0x0006\nAccessType=ro\n"
    "[6064]\nParameterName=位置 \x7F actual\tvalue\nObjectType=0x7\nDataType=0x0004\nAccessType=ro\n";

/// Every service, transfers of every kind, mappings learnt on the way, and texts a drive should not send.
constexpr std::string_view kLog[] = {"000#0100",
                                     "000#8205",
                                     "000#FF",
                                     "080#",
                                     "080#07",
                                     "100#00000000D03C",
                                     "100#00",
                                     "082#1081110000000000",
                                     "082#0000000000000000",
                                     "701#00",
                                     "701#05",
                                     "701#85",
                                     "701#R1",
                                     "701#0501",
                                     "181#3702",
                                     "181#R2",
                                     "201#0F00",
                                     "7FF#",
                                     "7E4#0102",
                                     "7E5#1105000000000000",
                                     "18FF0102#00",
                                     "20000004#0010000000000000",
                                     "20000040#0000000000000000",
                                     "20000FFF#FF",
                                     "601#4008100000000000",
                                     "581#4F081000220A0000",
                                     "581#43081000FF225C01",
                                     "601#4041600000000000",
                                     "581#4B41600037020000",
                                     "601#2B40600007000000",
                                     "581#6040600000000000",
                                     "601#2F60600003000000",
                                     "581#8060600000000206",
                                     "601#8041600000000405",
                                     "601#A00A100010000000",
                                     "581#C20A100007000000",
                                     "601#A3",
                                     "581#8141424344450A22",
                                     "601#A20110",
                                     "581#C1",
                                     "601#A1",
                                     "601#FF00000000000000",
                                     "601#2F001A0000000000",
                                     "581#60001A0000000000",
                                     "601#23001A0110004160",
                                     "581#60001A0110004160",
                                     "601#23001A0220006460",
                                     "581#60001A0200000000",
                                     "601#2F001A0002000000",
                                     "581#60001A0000000000",
                                     "181#3702F0D8FFFF",
                                     "181#3702"};

struct Logged {
  std::vector<std::string> lines;  ///< With `-o jsonl`.
  std::string list;                ///< With `--json`.
};

class Reader final : public show::Audience {
 public:
  void write(std::string_view text) override { lines += text; }
  std::string lines;
};

/// The whole log as the command writes it, on a bus of this name.
Logged write_log(std::string_view interface_name) {
  drive::Profile profile;
  profile.dictionary = od::read_eds(kHostileEds, "hostile.eds").value().dictionary;
  Logged out;
  Reader reader;
  auto& lines = reader.lines;
  const auto write = [&](show::Desk& desk) {
    desk.profile = &profile;
    desk.audience = &reader;
    FrameLog log(desk, {}, false);
    Duration time{1'700'000'000'000'000};
    for (const auto frame : kLog)
      log.add(time += Duration(100'101), interface_name, *can::parse_frame(frame));
    log.remark(time, "alarm", 2, "ALARM \"quoted\"", "heartbeat-lost");
    log.flush();
    out.list = report::to_json(log.take_kept());
  };
  show::Desk one_document;
  one_document.keeps_samples = true;
  write(one_document);
  EXPECT_EQ(lines, "");
  const auto kept = out.list;
  show::Desk samples;
  samples.wants_records = true;
  write(samples);
  out.list = kept;
  for (const auto line : split(std::string_view(lines), '\n')) out.lines.emplace_back(line);
  if (!out.lines.empty()) out.lines.pop_back();
  return out;
}

TEST(FrameLog, WritesWhatATreeOfValuesWouldGiveForEveryService) {
  const auto logged = write_log("can\"\\\n总线\xFF");
  ASSERT_EQ(logged.lines.size(), std::size(kLog) + 1);
  std::set<std::string> services;
  for (const auto& line : logged.lines) {
    const auto read = report::parse_json(line, "line");
    ASSERT_TRUE(read) << line;
    EXPECT_EQ(report::to_json(*read), line);
    services.insert(std::get<std::string>(report::find(*read, "service")->data()));
  }
  for (const auto service : kServices) EXPECT_EQ(services.count(std::string(service)), 1U) << service;
}

TEST(FrameLog, KeepsTheSameRecordsForOneDocument) {
  const auto logged = write_log("can0");
  std::string list;
  for (const auto& line : logged.lines) list += (list.empty() ? "[" : ",") + line;
  EXPECT_EQ(logged.list, list + "]");
}

TEST(FrameLog, WritesNamesThatNeedCareAsTheyAre) {
  const auto logged = write_log("can0");
  const auto pdo = *(logged.lines.end() - 3);
  EXPECT_EQ(
      pdo.substr(pdo.find("\"values\"")),
      R"("values":[{"index":24641,"sub":0,"name":"Status \"word\" \\ \u0001 {[:,","value":567,"raw":567,"unit":null,)"
      "\"label\":\"operation enabled (voltage enabled, remote)\"},"
      "{\"index\":24676,\"sub\":0,\"name\":\"位置 \\u007f "
      "actual\\tvalue\",\"value\":-10000,\"raw\":-10000,\"unit\":null,\"label\":null}],"
      "\"text\":\"TPDO1 Status \\\"word\\\" \\\\ \\u0001 {[:, 0x0237 operation enabled (voltage enabled, remote), 位置 \\u007f "
      "actual\\tvalue -10000\"}");
  EXPECT_EQ(
      logged.lines.back(),
      R"({"time":1700000005.205252,"service":"alarm","node":2,"event":"heartbeat-lost","text":"ALARM \"quoted\""})");
}

/// What is said of the last of these frames.
std::string last_text(std::initializer_list<std::string_view> frames) {
  drive::Profile profile;
  FrameDecoder::Options options;
  options.profile = &profile;
  FrameDecoder decoder(options);
  std::string out;
  for (const auto text : frames) out = decoder.decode(*can::parse_frame(text)).text;
  return out;
}

TEST(FrameLog, FindsEmergenciesUnderThe1014hThatWasReadOrWritten) {
  const auto* plain = "0F1#1082110000000000";
  EXPECT_EQ(last_text({plain}).substr(0, 11), "EMCY 0x8210");  // By its number that of node 113.
  EXPECT_EQ(last_text({"281#1082110000000000"}).substr(0, 5), "TPDO2");
  EXPECT_EQ(last_text({"601#4014100000000000", "581#4314100081020000", "281#1082110000000000"}).substr(0, 11),
            "EMCY 0x8210");
  EXPECT_EQ(last_text({"601#2314100081020000", "581#6014100000000000", "281#1082110000000000"}).substr(0, 11),
            "EMCY 0x8210");
  EXPECT_EQ(last_text({"601#2314100081020000", "581#8014100030000906", "281#1082110000000000"}).substr(0, 5),
            "TPDO2")
      << "it was refused";
  EXPECT_EQ(
      last_text({"601#4014100000000000", "581#4314100081020020", "00000281#1082110000000000"}).substr(0, 11),
      "EMCY 0x8210");
}

/// The last frame of these, behind what maps 6060h into RPDO1 and 6061h into TPDO1.
std::string last_of_mapped(std::vector<std::string_view> frames) {
  std::vector<std::string_view> all{"601#2F00160000000000", "581#6000160000000000", "601#2300160108006060",
                                    "581#6000160100000000", "601#2F00160001000000", "581#6000160000000000",
                                    "601#2F001A0000000000", "581#60001A0000000000", "601#23001A0108006160",
                                    "581#60001A0100000000", "601#2F001A0001000000", "581#60001A0000000000"};
  all.insert(all.end(), frames.begin(), frames.end());
  FrameDecoder decoder({});
  std::string out;
  for (const auto text : all) out = decoder.decode(*can::parse_frame(text)).text;
  return out;
}

constexpr std::string_view kHomingAttained = "homing attained";
constexpr std::string_view kAcknowledged = "set-point acknowledge";

/// What bit 12 of a statusword that is read behind these frames is called.
std::string bit_12_behind(std::vector<std::string_view> frames) {
  frames.insert(frames.end(), {"601#4041600000000000", "581#4B41600037160000"});
  const auto text = last_of_mapped(frames);
  for (const auto word : {kHomingAttained, kAcknowledged, std::string_view("bit 12")})
    if (text.find(word) != std::string::npos) return std::string(word);
  return text;
}

TEST(FrameLog, TakesTheModeFrom6060hUntil6061hTellsIt) {
  constexpr std::string_view kAsks6 = "601#2F60600006000000";
  constexpr std::string_view kTaken = "581#6060600000000000";
  constexpr std::string_view kReads = "601#4061600000000000";
  constexpr std::string_view kIs1 = "581#4F61600001000000";
  EXPECT_EQ(bit_12_behind({}), "bit 12");
  EXPECT_EQ(bit_12_behind({kAsks6, kTaken}), kHomingAttained);
  EXPECT_EQ(bit_12_behind({kAsks6}), "bit 12") << "nobody took it yet";
  EXPECT_EQ(bit_12_behind({kAsks6, "581#8060600000000206"}), "bit 12") << "it was refused";
  EXPECT_EQ(bit_12_behind({kAsks6, "581#8060600000000206", "601#2B60600001000000", kTaken}), "bit 12")
      << "what was taken is no mode";
  EXPECT_EQ(bit_12_behind({kReads, kIs1, kAsks6, "581#8060600000000206"}), kAcknowledged)
      << "the one before goes on";
  EXPECT_EQ(bit_12_behind({kReads, kIs1, kAsks6, kTaken}), kHomingAttained) << "it was written since";
  EXPECT_EQ(bit_12_behind({kAsks6, kTaken, kReads, kIs1}), kAcknowledged) << "what 6061h says wins";
  EXPECT_EQ(bit_12_behind({kAsks6, kTaken, "701#00"}), "bit 12") << "it started anew";
}

TEST(FrameLog, TakesTheModeFromPdosThatCarryIt) {
  EXPECT_EQ(bit_12_behind({"201#06"}), kHomingAttained);
  EXPECT_EQ(bit_12_behind({"181#01"}), kAcknowledged);
  EXPECT_EQ(bit_12_behind({"181#01", "201#06"}), kHomingAttained);
  EXPECT_EQ(bit_12_behind({"201#06", "181#01"}), kAcknowledged);
  EXPECT_EQ(bit_12_behind({"201#06", "181#01", "201#06"}), kAcknowledged) << "it is the same request";
  EXPECT_EQ(bit_12_behind({"201#06", "181#01", "201#01", "201#06"}), kHomingAttained);
  EXPECT_EQ(bit_12_behind({"201#"}), "bit 12") << "shorter than its mapping";
}

}  // namespace
}  // namespace servoctl::traffic
