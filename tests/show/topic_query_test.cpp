#include "show/topic_query.hpp"

#include <gtest/gtest.h>

#include "show/explanation.hpp"
#include "show/lead_words.hpp"
#include "show/topic_page.hpp"

namespace servoctl::show {
namespace {

drive::Topic inputs() {
  drive::Topic out;
  out.kind = "input";
  out.name = "DI functions";
  out.also = {"digital inputs", "输入功能"};
  out.title = "Functions of the digital inputs";
  out.title_zh = "数字输入功能";
  out.text = "The motor is disabled where nothing is wired.";
  out.columns = {"function", "symbol"};
  out.rows = {
      {{"FunIN.1", "S-ON"}, "", "", "1"}, {{"FunIN.28", "HOME"}, "", "", "2"}, {{"0x31", "5"}, "", "", "3"}};
  return out;
}

drive::Topic homing(std::int64_t method) {
  drive::Topic out;
  out.kind = "homing";
  out.name = "hm" + std::to_string(method);
  out.title = "Home switch and index";
  out.object = ObjectAddress{0x6098, 0};
  out.value = method;
  return out;
}

std::string found(std::string_view words, const drive::Topic& topic) {
  od::Dictionary dictionary;
  od::Object object;
  object.index = 0x6098;
  object.name = "Homing method";
  dictionary.add(object);
  const auto match = TopicQuery(words).match(topic, &dictionary);
  if (!match) return "-";
  std::string out(name(match->found));
  for (const auto row : match->rows) out += " " + std::to_string(row);
  return out;
}

TEST(TopicQuery, FindsNamesWhateverTheirCaseWidthAndBlanks) {
  for (const auto* words : {"DI functions", "di  FUNCTIONS", "DIfunctions", "DI_functions", "ＤＩ　functions",
                            "Digital Inputs", "输入功能"})
    EXPECT_EQ(found(words, inputs()), "name") << words;
}

std::vector<drive::EverydayWords> everyday() {
  return {{"braking resistor", {"braking resistor", "brake resistor", "制动电阻", "再生电阻"}, false},
          {"holding brake", {"brake", "抱闸"}, false},
          {"vibration", {"vibrat", "oscillat", "振动", "共振"}, true}};
}

TEST(TopicQuery, FindsAThingByWhateverPeopleCallIt) {
  const auto all = everyday();
  const auto finds = [&](std::string_view typed, std::string_view text) {
    return TopicQuery(typed, all).mentions(searchable(text));
  };
  EXPECT_TRUE(finds("制动电阻", "Braking resistor: internal or external"));
  EXPECT_TRUE(finds("brake resistor", "外置再生电阻阻值"));
  EXPECT_TRUE(finds("resistor brake", "外置再生电阻阻值"));
  EXPECT_TRUE(finds("external 制动电阻", "External braking resistor value"));
  EXPECT_FALSE(finds("internal 制动电阻", "External braking resistor value"));
  EXPECT_TRUE(finds("oscillations", "The load vibrates."));
  EXPECT_TRUE(finds("振动抑制", "Load oscillation 抑制"));
  EXPECT_FALSE(finds("制动电阻", "Terminating resistor"));
  EXPECT_FALSE(finds("brake", "Braking torque"));
}

TEST(TopicQuery, KnowsWhenAllThatWasTypedNamesOneThing) {
  const auto all = everyday();
  ASSERT_NE(TopicQuery("共振", all).thing(), nullptr);
  EXPECT_TRUE(TopicQuery("共振", all).thing()->absent);
  EXPECT_EQ(TopicQuery("brake resistor", all).thing()->name, "braking resistor");
  EXPECT_EQ(TopicQuery("brake vibration", all).thing(), nullptr);
  EXPECT_EQ(TopicQuery("vibration level", all).thing(), nullptr);
  EXPECT_EQ(TopicQuery("notch", all).thing(), nullptr);
}

TEST(TopicQuery, FoldsTheBlanksBesideChinese) {
  for (const auto* typed : {"S曲线", "S 曲线", "s 曲 线"})
    for (const auto* text : {"S曲线时间常数", "S 曲线 时间常数"})
      EXPECT_TRUE(TopicQuery(typed).mentions(searchable(text))) << typed << " in " << text;
  EXPECT_EQ(searchable({"增益 1", "gain"}), searchable({"增益1", "GAIN"}));
  EXPECT_NE(searchable({"a", "b"}), searchable("a b"));
}

TEST(TopicQuery, ReadsADisplayWithoutItsMarksAndZeros) {
  for (const auto* typed : {"AL.09", "AL09", "al9", "AL 9", "al-09"})
    EXPECT_TRUE(TopicQuery(typed).names_display("AL.09")) << typed;
  EXPECT_TRUE(TopicQuery("err 12").names_display("Err-12"));
  EXPECT_TRUE(TopicQuery("er12-2").names_display("Er12-2"));
  EXPECT_FALSE(TopicQuery("er1-22").names_display("Er12-2"));
  for (const auto* typed : {"AL.90", "AL", "9", "09"})
    EXPECT_FALSE(TopicQuery(typed).names_display("AL.09")) << typed;
  EXPECT_FALSE(TopicQuery("99").names_display("99"));
}

TEST(TopicQuery, FindsValuesOfAnObjectByItsIndexItsNameAndItsKind) {
  for (const auto* words : {"6098h=7", "0x6098 = 7", "homing_method=7", "6098 7", "homing method 7",
                            "homing 7", "home method 7", "Homing Method 0x7", "回零方式7", "回零 7"})
    EXPECT_EQ(found(words, homing(7)), "value") << words;
  EXPECT_EQ(found("homing -1", homing(-1)), "value");
  for (const auto* words : {"homing 8", "6098h=17", "6099h=7", "mode 7", "homing=7", "7"})
    EXPECT_NE(found(words, homing(7)), "value") << words;
}

TEST(TopicQuery, FindsRowsByACellOrByTheNumberBehindWhatIsCounted) {
  EXPECT_EQ(found("FunIN.28", inputs()), "row 1");
  EXPECT_EQ(found("s-on", inputs()), "row 0");
  EXPECT_EQ(found("DI 28", inputs()), "row 1");
  EXPECT_EQ(found("input 028", inputs()), "row 1");
  EXPECT_EQ(found("digital home", inputs()), "row 1");
  EXPECT_EQ(found("DI 49", inputs()), "-");
  EXPECT_EQ(found("DO 28", inputs()), "-");
  EXPECT_EQ(found("5", inputs()), "text") << "a digit alone names no row";
  auto steps = inputs();
  steps.columns[0] = "step";
  EXPECT_EQ(found("DI 28", steps), "text") << "nobody counts the steps of a procedure";
}

TEST(TopicQuery, ANumberIsThatOfTheRowAndNoEndOfAnother) {
  auto topic = inputs();
  topic.columns = {"value", "symbol"};
  topic.rows = {{{"1", "SON"}, "", "", "1"},     {{"10", "SP1"}, "", "", "2"},
                {{"0x1B", "TRQ1"}, "", "", "3"}, {{"28", "A1"}, "", "", "4"},
                {{"Er.15", "15"}, "", "", "5"},  {{"Er.A5", "GEAR1"}, "", "", "6"},
                {{"AL-16", "-"}, "", "", "7"},   {{"11, 19", "-"}, "", "", "8"},
                {{"20-22", "-"}, "", "", "9"},   {{"Er17-0", "-"}, "", "", "10"}};
  EXPECT_EQ(found("DI 1", topic), "row 0") << "not SP1, TRQ1, A1 and GEAR1";
  for (const auto* words : {"DI 1B", "DI 0x1b", "DI 1Bh", "DI 001b"})
    EXPECT_EQ(found(words, topic), "row 2") << words;
  for (const auto* words : {"DI 28", "DI 0x1C", "DI 1ch"}) EXPECT_EQ(found(words, topic), "row 3") << words;
  EXPECT_EQ(found("DI 15", topic), "row 4");
  EXPECT_EQ(found("DI 16", topic), "row 6");
  EXPECT_EQ(found("DI 19", topic), "row 7");
  EXPECT_EQ(found("DI 21", topic), "row 8");
  for (const auto* words : {"DI 5", "DI 0", "DI 17", "DI 27", "DI 9", "DI 2"})
    EXPECT_NE(found(words, topic).substr(0, 3), "row") << words;
  EXPECT_EQ(found("DI symbol 15", topic), "-") << "the heading is no name of the topic";
}

TEST(TopicQuery, AHexadecimalNumberNamesTheRowByItself) {
  auto topic = inputs();
  topic.columns = {"code", "value"};
  topic.rows = {
      {{"0x001B", "27"}, "", "", "1"}, {{"27", "0x1C"}, "", "", "2"}, {{"20-30", "-"}, "", "", "3"}};
  for (const auto* words : {"0x001B", "1Bh", "0x1b", "001B"}) {
    EXPECT_EQ(found(words, topic), "row 0") << words;
    EXPECT_EQ(TopicQuery(words).match_name(topic)->rows, std::vector<std::size_t>{0}) << words;
  }
  EXPECT_EQ(found("27", topic), "text");
  topic.columns[1] = "step";
  EXPECT_EQ(found("1Bh", topic), "-") << "what is written in a step is not its number";
}

TEST(TopicQuery, ColumnsOfBitsAndInputsNumberNoRows) {
  auto topic = inputs();
  topic.kind = "bits";
  topic.columns = {"command", "bit 7", "transition"};
  topic.rows = {{{"Shutdown", "1", "2"}, "", "", "1"}, {{"Fault reset", "0", "1"}, "", "", "2"}};
  for (const auto* words : {"bit 1", "DI 1"}) EXPECT_NE(found(words, topic).substr(0, 3), "row") << words;
  topic.also = {"transition"};
  EXPECT_EQ(found("transition 1", topic), "row 1");
}

TEST(TopicQuery, TextsMentionWholeNumbersOnly) {
  auto topic = inputs();
  topic.rows.clear();
  const auto mentions = [&](const char* text) {
    topic.text = text;
    return found("15", topic) == "text";
  };
  for (const auto* text : {"bit 15 is", "bits 8-15", "15-16", "15", "(15).", "Er.15", "PA-15", "为15时"})
    EXPECT_TRUE(mentions(text)) << text;
  for (const auto* text : {"0.15 mm", "15.5 kg", "method -15", "P3-15", "1,15", "1500", "115", "15ms"})
    EXPECT_FALSE(mentions(text)) << text;
}

TEST(TopicQuery, TakesOnlyNamesAndWholeCellsWhereNobodyNamedTheFamily) {
  EXPECT_EQ(TopicQuery("FunIN.28").match_name(inputs())->rows, std::vector<std::size_t>{1});
  EXPECT_EQ(TopicQuery("DI functions").match_name(inputs())->found, Found::name);
  for (const auto* words : {"DI 28", "functions", "motor", "input"})
    EXPECT_FALSE(TopicQuery(words).match_name(inputs())) << words;
}

TEST(TopicQuery, FindsRowsByAQuantity) {
  auto lengths = inputs();
  lengths.name = "cable length";
  lengths.rows = {{{"1 Mbit/s", "25 m"}, "", "", "1"},
                  {{"500 kbit/s", "100 m"}, "", "", "2"},
                  {{"50 kbit/s", "1000 m"}, "", "", "3"}};
  EXPECT_EQ(found("cable 500", lengths), "row 1");
  EXPECT_EQ(found("cable length 500k", lengths), "row 1");
  EXPECT_EQ(found("cable 50k", lengths), "row 2");
  EXPECT_EQ(found("500 kbit/s", lengths), "row 1");
  EXPECT_EQ(found("cable 5", lengths), "-");
}

TEST(TopicQuery, FindsWordsInTitlesBeforeThoseInTexts) {
  EXPECT_EQ(found("functions digital", inputs()), "title");
  EXPECT_EQ(found("func", inputs()), "title");
  EXPECT_EQ(found("数字", inputs()), "title");
  EXPECT_EQ(found("input", inputs()), "title");
  EXPECT_EQ(found("wired motor", inputs()), "text");
  EXPECT_EQ(found("unctions", inputs()), "-") << "English words from their beginning";
  EXPECT_EQ(found("is di", inputs()), "text");
  EXPECT_EQ(found("di sab", inputs()), "-");
  EXPECT_EQ(found("motor encoder", inputs()), "-");
  EXPECT_EQ(found("", inputs()), "-");
}

TEST(AlStatus, EveryCodeIsFoundInBothLanguages) {
  const auto topic = al_status_topic();
  EXPECT_GT(topic.rows.size(), 50U);
  for (const auto& row : topic.rows) {
    EXPECT_EQ(found("AL status " + row.cells[0], topic).substr(0, 4), "row ") << row.cells[0];
    EXPECT_NE(row.text, row.text_zh) << row.cells[0];
    EXPECT_EQ(row.text.back() == ' ' || row.text_zh.ends_with("；"), false) << row.cells[0];
  }
  EXPECT_EQ(found("AL status", topic), "name");
  EXPECT_EQ(found("AL 状态码", topic), "name");
}

TEST(Explanations, AWordForFaultsLeadsToTheNumberOfADisplay) {
  drive::Profile profile;
  for (const auto* panel : {"Err-5", "Err-52", "Er52-1"}) {
    drive::Fault fault;
    fault.panel = panel;
    profile.faults.push_back(fault);
  }
  const auto names = [&](std::string_view words, bool by_name_only) {
    const Library library{&profile, {}, by_name_only};
    std::string out;
    for (const auto& each : explanations(TopicQuery(words), {&library, 1}, false))
      out += each.topic.name + " ";
    return out;
  };
  for (const auto* words : {"fault 52", "alarm 052", "故障码52"})
    EXPECT_EQ(names(words, false), "Err-52 ") << words;
  EXPECT_EQ(names("fault 2", false), "");
  EXPECT_EQ(names("fault 52", true), "") << "nobody named the family";
}

TEST(Explanations, AFaultThatIsLedToStandsBeforeARowOfItsCode) {
  drive::Profile profile;
  drive::Fault fault;
  fault.code = 0x8130;
  profile.faults.push_back(fault);
  auto classes = inputs();
  classes.name = "EMCY codes";
  classes.rows = {{{"8130h", "-"}, "", "", "1"}};
  const Library library{&profile, {classes}, false};
  const auto all = explanations(TopicQuery("emcy 0x8130"), {&library, 1}, false);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].found, Found::fault);
  EXPECT_EQ(all[1].found, Found::row);
}

TEST(ExitCodes, TellEveryErrorOnce) {
  const auto topic = exit_code_topic();
  std::vector<std::string> told;
  for (const auto& row : topic.rows) told.push_back(row.cells[0] + " " + row.cells[1]);
  std::vector<std::string> codes{"0 "};
  for (int code = 0; code <= static_cast<int>(Errc::interrupted); ++code) {
    const auto error = static_cast<Errc>(code);
    codes.push_back(std::to_string(exit_code(error)) + " " + std::string(servoctl::name(error)));
  }
  EXPECT_EQ(told, codes);
}

TEST(LeadWords, StandBeforeWhatTheySay) {
  const auto led = [](std::string_view text) {
    const auto out = without_lead(text);
    return out ? std::string(name(out->found)) + " " + out->rest : std::string("-");
  };
  EXPECT_EQ(led("abort 06090030"), "abort 06090030");
  EXPECT_EQ(led("SDO abort code 0x06090030"), "abort 0x06090030");
  EXPECT_EQ(led("SDO 中止码 0x06090030"), "abort 0x06090030");
  EXPECT_EQ(led("EMCY: 0x8130"), "fault 0x8130");
  EXPECT_EQ(led("故障码8130"), "fault 8130");
  EXPECT_EQ(led("object 6041"), "object 6041");
  for (const auto* text : {"aborted 3", "abort", "emcy", "homing 7", "中止"})
    EXPECT_EQ(led(text), "-") << text;
}

TEST(TopicPage, HasTheMarksOfChineseWhateverTheFileHas) {
  Explanation explanation;
  explanation.topic.title_zh = "点动 (pp)";
  explanation.topic.text_zh = "写 0x80 (复位)";
  std::string page;
  for (const auto& line : topic_page(explanation, true, 80)) page += line + "\n";
  EXPECT_NE(page.find("点动（pp）"), std::string::npos) << page;
  EXPECT_NE(page.find("写 0x80（复位）"), std::string::npos) << page;
}

TEST(TopicPage, LeavesChineseNamesToWhoReadsChinese) {
  Explanation explanation;
  explanation.topic.also = {"position mode", "位置模式"};
  const auto page = [&](bool chinese) {
    std::string out;
    for (const auto& line : topic_page(explanation, chinese, 80)) out += line + "\n";
    return out;
  };
  EXPECT_NE(page(false).find("position mode"), std::string::npos);
  EXPECT_EQ(page(false).find("位置模式"), std::string::npos);
  EXPECT_NE(page(true).find("位置模式"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::show
