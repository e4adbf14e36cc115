// Logs as tools write them, with the options that change their lines. Each case was made by hand after the
// description or the sources of the tool; the traffic is that of one drive.
#include "can/log_formats.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/can/recording_bytes.hpp"

namespace servoctl::can {
namespace {

using Frames = std::vector<std::string>;

/// A read of the statusword and its answer.
const Frames kTalk{"601#4041600000000000", "581#4B41600037060000"};

/// The frames of a recording without times and buses, then what was left out.
Frames bare_frames(std::string_view text) {
  Frames out;
  for (const auto& line : frames_of(text)) {
    const auto frame = line.starts_with('(') ? line.rfind(' ') + 1 : 0;
    out.push_back(line.substr(frame));
  }
  return out;
}

/// Without the notices beside them.
Frames frames_alone(std::string_view text) {
  auto out = bare_frames(text);
  std::erase_if(out, [](const std::string& line) { return line.find('#') == std::string::npos; });
  return out;
}

RecordingStrays strays_of(std::string_view text, const ReadOptions& options = {}) {
  return for_each_frame(
      text, [](const LogFrame&) { return true; }, options);
}

TEST(LogFormats, ToolsOfWordsBetweenBlanks) {
  const std::string_view logs[] = {
      // CANreal
      "1\t  \t20:28:03\t010.000\t 0.407\t\t 1537\t 601\t  \t 8\t40\t41\t60\t00\t00\t00\t00\t00\t____\t\n"
      "2\t  \t20:28:03\t011.000\t 0.407\t\t 1409\t 581\t  \t 8\t4B\t41\t60\t00\t37\t06\t00\t00\t____\t\n",
      // CanKing
      "Chn Identifier Flg   DLC  D0...1...2...3...4...5...6..D7       Time     Dir\n"
      " 0    00000601         8  40  41  60  00  00  00  00  00     100.000139 T\n"
      " 0    00000581         8  4B  41  60  00  37  06  00  00     100.001139 R\n"
      "Logging stopped.\n",
      // BUSMASTER
      "***BUSMASTER Ver 3.2.2***\n***PROTOCOL CAN***\n***HEX***\n***SYSTEM MODE***\n"
      "13:59:38:0099 Tx 1 0x601 s 8 40 41 60 00 00 00 00 00 \n"
      "13:59:38:0100 Rx 1 0x581 s 8 4B 41 60 00 37 06 00 00 \n***[STOP LOGGING SESSION]***\n",
      "***BUSMASTER Ver 3.2.2***\n***DEC***\n***RELATIVE MODE***\n"
      "00:00:01:0000 Tx 1 1537 s 8 64 65 96 0 0 0 0 0 \n"
      "00:00:00:0010 Rx 1 1409 s 8 75 65 96 0 55 6 0 0 \n",
      // CANoe
      "0.010000  CAN 1  601  Tx  d 8 40 41 60 00 00 00 00 00\n"
      "0.011000  CAN 1  581  Rx  d 8 4B 41 60 00 37 06 00 00\n",
      "0.010000  CAN 1  1537  Tx  d 8 64 65 96 0 0 0 0 0\n"
      "0.011000  CAN 1  1409  Rx  d 8 75 65 96 0 55 6 0 200\n",
      // python-can on a terminal
      "Timestamp:        3.050000        ID: 0601    S Tx                DL:  8    40 41 60 00 00 00 00 00\n"
      "Timestamp:        3.051000        ID: 0581    S Rx                DL:  8    4b 41 60 00 37 06 00 00     "
      "'KA`.7...'     Channel: can0\n",
      // CRTD
      "1320745424.123 T11 601 40 41 60 00 00 00 00 00\n1320745424.124 R11 581 4B 41 60 00 37 06 00 00\n",
      // Lines that people write.
      "0x601: 0x40 0x41 0x60 0x00 0x00 0x00 0x00 0x00\n0x581: 0x4B 0x41 0x60 0x00 0x37 0x06 0x00 0x00\n",
      "Tx 601h 8 40 41 60 00 00 00 00 00\nRx 581h [8] 4B 41 60 00 37 06 00 00 # it is on\n",
      "601 4041600000000000\n581 4B41600037060000\n",
      "1) 0.010 601 8 40 41 60 00 00 00 00 00\n2) 0.011 581 8 4B 41 60 00 37 06 00 00\n",
      "cansend can0 601#40.41.60.00.00.00.00.00\nsudo cansend can0 581#4B41600037060000; sleep 1\n",
  };
  for (const auto log : logs) {
    auto frames = bare_frames(log);
    if (frames.size() == 2 && frames[1] == "581#4B416000370600C8") frames[1] = kTalk[1];
    EXPECT_EQ(frames, kTalk) << log;
  }
}

TEST(LogFormats, TablesWhoseHeaderNamesTheColumns) {
  const std::string_view logs[] = {
      // IXXAT, absolute and relative, with commas and semicolons
      "ASCII Trace IXXAT\nDate: 21.11.2026\n\"Bus\",\"No\",\"Time (abs)\",\"State\",\"ID (hex)\",\"DLC\",\"Data "
      "(hex)\",\"ASCII\"\n\"CAN-1\",\"1\",\"00:00:03.050\",\"\",\"601\",\"8\",\"40 41 60 00 00 00 00 00\",\"@A`\"\n"
      "\"CAN-1\",\"2\",\"00:00:03.051\",\"\",\"581\",\"8\",\"4B 41 60 00 37 06 00 00\",\"KA,7\"\n",
      "\"Time (rel)\";\"Identifier (dec)\";\"Format\";\"Flags\";\"Data (dec)\"\r\n"
      "\"00:00:03.050\";\"1537\";\"Std\";\"\";\"64 65 96 0 0 0 0 0\"\r\n"
      "\"00:00:00.001\";\"1409\";\"Std\";\"\";\"75 65 96 0 55 6 0 0\"\r\n",
      // Vehicle Spy
      "Vehicle Spy 3 Bus Traffic File\nSave Date,11/21/2026\n\n"
      "Line,Abs Time(Sec),Rel Time (Sec),Status,Er,Tx,Description,Network,Node,Arb ID,Remote/EDL-BRS-ESI,Xtd,B1,B2,"
      "B3,B4,B5,B6,B7,B8,Value,Trigger,Signals\n"
      "Line,Abs Time(Sec),Rel Time (Sec),Status,Er,Tx,Description,Network,Node,PT,Trgt,Src,B1,B2,B3,B4,B5,B6,B7,B8,"
      "Value,Trigger,Signals\n"
      "1,2550.368293675,0.003818174999651092,67371008,F,T,HS CAN $601,HS "
      "CAN,,601,F,F,40,41,60,00,00,00,00,00,,,\n"
      "2,2550.37,0.001,67371008,F,F,HS CAN $581,HS CAN,,581,F,F,4B,41,60,00,37,06,00,00,,,\n",
      // SavvyCAN
      "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n"
      "166064000,00000601,false,Tx,0,8,40,41,60,00,00,00,00,00,\n"
      "166065000,00000581,false,Rx,0,8,4B,41,60,00,37,06,00,00,\n",
      // python-can
      "timestamp,arbitration_id,extended,remote,error,dlc,data\n"
      "1483389946.197,0x601,0,0,0,8,QEFgAAAAAAA=\n1483389946.198,0x581,0,0,0,8,S0FgADcGAAA=\n",
      // USBCAN of ZLG and Chuangxin
      "序号,传输方向,时间标识,名称,帧ID(靠右对齐),帧类型,帧格式,数据长度,数据(HEX)\n"
      "0,发送,13:44:54.050,,0x00000601,数据帧,标准帧,0x08,40 41 60 00 00 00 00 00 \n"
      "1,接收,13:44:54.051,,0x00000581,数据帧,标准帧,0x08,4B 41 60 00 37 06 00 00 \n",
      "序号,系统时间,时间标识,CAN通道,传输方向,ID号,帧类型,帧格式,长度,数据\r\n"
      "00000,=\"14:22:33.123.5\",=\"0x18D3\",ch1,发送,0x 0601,数据帧,标准帧,0x 08,x| 40 41 60 00 00 00 00 00 \r\n"
      "00001,=\"14:22:33.124.5\",=\"0x18D4\",ch1,接收,0x 0581,数据帧,标准帧,0x 08,x| 4B 41 60 00 37 06 00 00 \r\n",
      // Anybody's
      "Zeit [ms]\tCAN-ID (hex)\tLänge\tDaten\n10\t601\t8\t4041600000000000\n11\t581\t8\t4B41600037060000\n",
  };
  for (const auto log : logs) EXPECT_EQ(bare_frames(log), kTalk) << log;
}

TEST(LogFormats, ExtendedRemoteErrorAndFdFrames) {
  EXPECT_EQ(bare_frames(" 0    0CFBFFDB X       2  1B  31                            100.000139 R\n"
                        " 0    00000701   R     1                                      102.1 T\n"
                        " 0    00000000            ErrorFrame                         103.1 R\n"),
            (Frames{"0CFBFFDB#1B31", "701#R1", "20000008#0000000000000000"}));
  EXPECT_EQ(
      bare_frames("***HEX***\n13:59:38:0099 Rx 1 0x18FF0001 x 2 01 FF\n13:59:38:0099 Rx 1 0x701 sr 1\n"),
      (Frames{"18FF0001#01FF", "701#R1"}));
  EXPECT_EQ(bare_frames(
                "Timestamp: 1.0    ID: 00000701    X Rx      DL:  1    05\n"
                "Timestamp: 2.0    ID: 0701    S Rx   R    DL:  1    Channel: can0\n"
                "Timestamp: 3.0    ID: 0701    S Rx E      DL:  0\n"
                "Timestamp: 4.0    ID: 0701    S Rx   F BS DL: 12    01 02 03 04 05 06 07 08 09 0a 0b 0c\n"),
            (Frames{"00000701#05", "701#R1", "20000008#0000000000000000", "unsuited 1"}));
  EXPECT_EQ(bare_frames("Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2\n1,18FF0001,true,Rx,0,1,05,00,\n"),
            Frames{"18FF0001#05"});
  EXPECT_EQ(bare_frames(
                "帧ID,帧类型,帧格式,数据长度,数据\n0x701,远程帧,标准帧,1,\n0x18FF0001,数据帧,扩展帧,1,05\n"),
            (Frames{"701#R1", "18FF0001#05"}));
}

TEST(LogFormats, TextsOfOtherEncodings) {
  // 帧ID,数据 in GBK, then the same line in UTF-16 with a byte order mark.
  EXPECT_EQ(bare_frames("\xD6\xA1ID,\xCA\xFD\xBE\xDD\r\n0x701,05\r\n"), Frames{"701#05"});
  std::string wide("\xFF\xFE");
  for (const char c : std::string_view("ID,Data\r\n0x701,05\r\n")) wide += std::string({c, '\0'});
  EXPECT_EQ(bare_frames(wide), Frames{"701#05"});
  std::string big("\xFE\xFF");
  for (const char c : std::string_view("can0  701   [1]  05\n")) big += std::string({'\0', c});
  EXPECT_EQ(bare_frames(big), Frames{"701#05"});
}

TEST(LogFormats, AMailKeepsItsFrames) {
  EXPECT_EQ(bare_frames("Hello,\n> >   can0  601   [8]  40 41 60 00 00 00 00 00   <- asked\n"
                        "> (1.5) can0 581#4B41600037060000 # answered\n"),
            (Frames{kTalk[0], kTalk[1], "unknown 1 at 1"}));
  EXPECT_EQ(bare_frames("\x1B[31m  can0  701\x1B[0m   [1]  05\n"), Frames{"701#05"});
}

TEST(LogFormats, DifferencesOfTimesAreAddedUp) {
  EXPECT_EQ(frames_of(" (000.000000)  can0  701   [1]  05\n (000.200000)  can0  701   [1]  05\n"
                      " (000.100000)  can0  701   [1]  05\n"),
            (Frames{"(0000000000.000000) can0 701#05", "(0000000000.200000) can0 701#05",
                    "(0000000000.300000) can0 701#05"}));
  EXPECT_EQ(frames_of("Delta Time,ID,Data\n0.5,0x701,05\n0.25,0x701,05\n").back(),
            "(0000000000.750000) can1 701#05");
  EXPECT_EQ(frames_of("23:59:59.5 Rx 1 0x701 s 1 05\n00:00:00.5 Rx 1 0x701 s 1 05\n").back(),
            "(0000086400.500000) can1 701#05")
      << "past midnight";
}

TEST(LogFormats, WhatNobodyCanTellIsAsked) {
  const auto open = strays_of("601 40 41 60 10 10 10 10 10\n");
  EXPECT_EQ(open.open_base, 1U);
  const auto hex = ColumnChoice::parse("id:hex,data:hex");
  ASSERT_TRUE(hex);
  EXPECT_EQ(strays_of("601 40 41 60 10 10 10 10 10\n", {.columns = &*hex}).open_base, 0U);
  EXPECT_EQ(strays_of("601 40 41 60 00 00 00 00 00\n").assumed_base, 16U);
  EXPECT_EQ(strays_of("1537 40 41 60 00 00 00 00 00\n").assumed_base, 10U) << "11 bits in decimal only";
  EXPECT_EQ(bare_frames("129 17 12 200 0 0 0 0 0\n"), Frames{"081#110CC80000000000"}) << "as its data";
  EXPECT_EQ(strays_of("129 17 12 200 0 0 0 0 0\n").assumed_base, 10U);
  EXPECT_EQ(strays_of("081 40 41 60 00 00 00 00 00\n").assumed_base, 0U) << "zeros in front are hexadecimal";
  EXPECT_TRUE(strays_of("Time,ID,Data\n100,0x701,05\n").lacks_unit);
  EXPECT_FALSE(strays_of("Time (ms),ID,Data\n100,0x701,05\n").lacks_unit);
}

TEST(LogFormats, ColumnsThatTheUserNames) {
  const auto read = [](std::string_view columns, std::string_view text) {
    const auto choice = ColumnChoice::parse(columns);
    if (!choice) return Frames{choice.error().message.text()};
    Frames out;
    (void)for_each_frame(text, [&](const LogFrame& line) { return out.push_back(to_string(line)), true; },
                         {.columns = &*choice});
    return out;
  };
  EXPECT_EQ(read("time:ms,-,id:dec,len,data", "10;x;1793;1;05\n"), Frames{"(0000000000.010000) can1 701#05"});
  EXPECT_EQ(read("time=t,id:dec=CAN ID,data:hex=Payload", "t,CAN ID,x,Payload\n0.5,1793,?,05\n"),
            Frames{"(0000000000.500000) can1 701#05"});
  EXPECT_EQ(read("id:hex,byte:hex", "A header\nid,b1\n601,40,41,60,00\n"),
            Frames{"(0000000000.000000) can1 601#40416000"});
  EXPECT_EQ(read("time,di,data", ""), Frames{"'di' is no column"});
  EXPECT_EQ(read("time,id:ms,data", ""), Frames{"'ms' is no way to write the column id"});
  EXPECT_EQ(read("time,data", ""), Frames{"--columns names no identifier"});
  EXPECT_EQ(read("time,id", ""), Frames{"--columns names no data"});
  EXPECT_EQ(read("time=t,id,data=d", ""), Frames{"some of the columns have a name, and some have none"});
}

TEST(LogFormats, ALastLineWithoutAnEndIsReadIfItIsWhole) {
  EXPECT_EQ(bare_frames("can0  701   [1]  05"), Frames{"701#05"});
  EXPECT_EQ(bare_frames("(1.0) can0 581#4B41600037060000"), Frames{"581#4B41600037060000"})
      << "no frame is longer";
  EXPECT_EQ(bare_frames("(1.0) can0 701#00\n(1.1) can0 701#05"), (Frames{"701#00", "701#05"}))
      << "as the one before";
  EXPECT_EQ(bare_frames("(1.0) can0 701#05"), Frames{"damage at 0: its last line has no end"});
  EXPECT_EQ(bare_frames("can0  581   [8]  4B 41 60 00 37 06 00"),
            Frames{"damage at 0: its last line has no end"});
  EXPECT_EQ(bare_frames("ID,DLC,Data\n0x601,2,40 00\n0x601,2,40 4"),
            (Frames{"601#4000", "damage at 26: its last line has no end"}));
}

TEST(LogFormats, ProseIsNoRecording) {
  EXPECT_EQ(bare_frames("Copyright 2026 by everybody\nadd 00 to the 100 dead\nversion 2 of 1991\n"),
            Frames{"unknown 3 at 1"});
}

TEST(LogFormats, EveryPatternIsOfWordsThatAreKnown) {
  for (const auto& format : log_formats()) {
    LogCells cells;
    EXPECT_FALSE(LogPattern(format).match("", cells)) << format.name;
  }
}

TEST(LogFormats, TheNumbersOfByteColumnsTellTheirPlaces) {
  EXPECT_EQ(frames_alone("ID (hex),DLC,D7,D6,D5,D4,D3,D2,D1,D0\n201,8,08,07,06,05,04,03,02,01\n"),
            Frames{"201#0102030405060708"});
  EXPECT_TRUE(frames_alone("ID (hex),DLC,D0,D2,D3\n201,3,08,07,06\n").empty()) << "one is missing";
}

TEST(LogFormats, DataOfAnUnknownBaseAreToldApartFromIdentifiers) {
  const auto strays = strays_of("ID,DLC,D0,D1\n60A,2,43,64\n20A,2,15,10\n");
  EXPECT_EQ(strays.assumed_base, 0U) << "letters";
  EXPECT_EQ(strays.assumed_data_base, 16U);
  EXPECT_EQ(strays_of("ID,DLC,D0,D1\n60A,2,43,04\n").assumed_data_base, 0U) << "zeros in front";
}

TEST(LogFormats, EachSessionOfALogHasItsOwnMode) {
  const std::string hex = "***HEX***\n10:00:00:0000 Rx 1 0x181 s 2 37 02\n";
  const std::string decimal = "***DEC***\n10:00:01:0000 Rx 1 385 s 2 55 2\n";
  EXPECT_EQ(frames_alone(hex + decimal), (Frames{"181#3702", "181#3702"}));
  EXPECT_EQ(frames_alone(decimal + hex), (Frames{"181#3702", "181#3702"}));
}

TEST(LogFormats, WhereOtherColumnsBeginTheRecordingEnds) {
  const std::string hex = "Time (s),ID (hex),DLC,Data (hex)\n0.1,181,2,37 02\n";
  const auto both = hex + "Time (s),ID (dec),DLC,Data (dec)\n0.2,385,2,55 2\n";
  EXPECT_EQ(frames_alone(both), Frames{"181#3702"});
  ASSERT_TRUE(strays_of(both).damage);
  EXPECT_EQ(strays_of(both).damage->offset, hex.size());
  EXPECT_EQ(frames_alone(hex + hex).size(), 2U) << "the same once more";
}

TEST(LogFormats, AWordThatSaysNothingKnownMakesNoFrame) {
  const std::string_view lines[] = {
      "ID (hex),Extended,Data (hex)\n601,vielleicht,40 41\n",
      "ID (hex),Type,Data (hex)\n601,strange,40 41\n",
      "ID (hex),Type,DLC,Data (hex)\n601,R,2,40 41\n",  // Remote, or received?
      "ID (hex),Type,DLC,Data (hex)\n601,Error active,2,40 41\n",
      "ID (hex),RTR,DLC,Data (hex)\n601,1,2,40 41\n",
      "ID (hex),D0 (hex),D1,D2\n601,40,,60\n",
      "ID (hex),Data (hex)\n0000001537,40 41\n",
  };
  for (const auto line : lines) {
    EXPECT_TRUE(frames_alone(line).empty()) << line;
    EXPECT_EQ(strays_of(line).unknown, 1U) << line;
  }
  EXPECT_EQ(frames_alone("ID (hex),Extended,Data (hex)\n601,WAHR,40 41\n601,FALSCH,40 41\n"),
            (Frames{"00000601#4041", "601#4041"}));
  EXPECT_EQ(frames_alone("ID (hex),Type,Data (hex)\n601,29-bit,40 41\n"), Frames{"00000601#4041"});
  EXPECT_EQ(strays_of("ID (hex),EDL,Data (hex)\n601,1,40 41\n").unsuited, 1U);
}

TEST(LogFormats, AnIdentifierInFrontIsNoNumberOfALine) {
  EXPECT_EQ(frames_alone("201 0600\n"), Frames{"201#0600"});
  EXPECT_EQ(frames_alone("000 8101\n"), Frames{"000#8101"});
  EXPECT_EQ(frames_alone("7 601 8 40 41 60 00 00 00 00 00\n"), Frames{kTalk[0]});
  EXPECT_TRUE(frames_alone("1) 601 0181 2 37 02\n").empty());
}

TEST(LogFormats, OfTwoCommandsOnALineNoneIsLeftOut) {
  EXPECT_EQ(strays_of("cansend can0 601#40\ncansend can0 601#41; cansend can0 601#42\n").unknown, 1U);
  EXPECT_EQ(frames_alone("cansend can0 601#40\ntrue # cansend can0 000#0101\n"), Frames{"601#40"});
}

TEST(LogFormats, ALastLineThatMayBeCutIsNotTrusted) {
  const std::string_view cut[] = {
      "***DEC***\n10:00:00:0000 Rx 1 385 s 2 55 2\n10:00:00:0000 Rx 1 385 s 2 55 12",
      "DLC,Data (hex),ID (hex)\n2,37 02,181\n2,37 02,18",
      "ID (hex),DLC,Data (hex),Extended\n601,2,37 02,0\n601,2,37 02",
  };
  for (const auto text : cut) EXPECT_TRUE(strays_of(text).damage) << text;
}

}  // namespace
}  // namespace servoctl::can
