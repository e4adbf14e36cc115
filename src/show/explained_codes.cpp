#include "base/format.hpp"
#include "show/explanation_parts.hpp"

#include <utility>

#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"
#include "ethercat/al_status.hpp"
#include "report/catalogue.hpp"
#include "show/printed_number.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

constexpr std::string_view kProgram = "servoctl";

std::string chinese_of(std::string_view english) { return std::string(report::chinese_word(english)); }

}  // namespace

void add_abort(const TopicQuery& query, const drive::Profile& profile, std::vector<Explanation>& out) {
  constexpr std::size_t kDigits = 8;
  const auto code = code_in(query.whole(), kDigits);
  if (!code || query.whole().size() < kDigits) return;
  const auto number = static_cast<std::uint32_t>(*code);
  const auto error_class = number >> 24U;
  const bool own = profile.rules.abort_texts.count(number) > 0;
  if (!own && error_class != 0x05 && error_class != 0x06 && error_class != 0x08) return;
  const auto name = formatted("0x{:08X}", number);
  const std::string words_zh(report::chinese_word(abort_words(&profile, true, number)));
  const auto words = abort_words(&profile, false, number);
  constexpr std::string_view kTitle = "SDO abort code {}: {}";
  auto topic = topic_heading(profile.family, "abort", name, formatted(kTitle, name, words),
                             words_zh == words
                                 ? std::string()
                                 : formatted(fmt::runtime(report::chinese_word(kTitle)), name, words_zh));
  topic.text = canopen::sdo_abort_hint(number);
  topic.text_zh = report::in_chinese(topic.text);
  topic.line = canopen::is_standard_sdo_abort(number) ? "CiA 301, 7.2.4.3.17" : "";
  out.push_back({std::move(topic), Found::abort});
}

void add_exit_code(const TopicQuery& query, std::vector<Explanation>& out) {
  auto topic = exit_code_topic();
  const auto match = query.match(topic, nullptr);
  if (!match || (match->found != Found::name && match->found != Found::row)) return;
  out.push_back({std::move(topic), Found::exit, match->rows});
}

drive::Topic exit_code_topic() {
  constexpr std::string_view kTitle = "Exit codes of servoctl";
  constexpr std::string_view kCode = "exit code";
  auto out =
      topic_heading(kProgram, "exit", std::string(kExitCodes), std::string(kTitle), chinese_of(kTitle));
  out.also = {"exit", std::string(kCode), chinese_of(kCode)};
  out.columns = {std::string(kCode), "error.code"};
  out.columns_zh = {chinese_of(kCode), "error.code"};
  const auto row = [&](int code, std::string_view name, std::string_view text) {
    out.rows.push_back({{formatted("{}", code), std::string(name)}, std::string(text), chinese_of(text), {}});
  };
  const auto error = [&](Errc code, std::string_view text) {
    row(exit_code(code), servoctl::name(code), text);
  };
  row(0, "", "done");
  error(Errc::negative, "it ran, and the answer is no: a difference, a failed check, an incomplete result");
  error(Errc::usage, "the request itself is wrong; nothing was changed");
  error(Errc::bus, "the bus is missing, down or lost");
  error(Errc::timeout, "the node did not answer in time");
  error(Errc::sdo_abort, "the drive answered and refused");
  error(Errc::protocol, "the drive answered with something the protocol does not allow");
  error(Errc::file, "a file cannot be read, written or parsed");
  error(
      Errc::refused,
      "refused for safety: a confirmation is missing (--yes), --read-only forbids it, or the drive is not what "
      "-d says");
  error(Errc::bug, "a fault of servoctl itself");
  error(Errc::interrupted, "interrupted by Ctrl-C");
  return out;
}

drive::Topic al_status_topic() {
  constexpr std::string_view kTitle = "Why a slave of EtherCAT refused or left a state";
  constexpr std::string_view kText =
      "A slave of EtherCAT tells the code in its register 0134h, beside the state it is in (0130h). `scan` shows "
      "both, and what to do.";
  constexpr std::string_view kCode = "code";
  auto out = topic_heading(drive::kStandardFamily, "state", std::string(kAlStatusCodes), std::string(kTitle),
                           chinese_of(kTitle));
  constexpr std::string_view kStatusCode = "AL status code";
  out.also = {"AL status", std::string(kStatusCode), chinese_of(kStatusCode), "0134h", "0x0134"};
  out.text = kText;
  out.text_zh = chinese_of(kText);
  out.columns = {std::string(kCode)};
  out.columns_zh = {chinese_of(kCode)};
  out.line = "ETG.1000.6, table 11; ETG.1020, 5.7";
  const auto row = [&](std::string cell, std::uint16_t status) {
    auto text = ethercat::al_status_text(status);
    auto text_zh = chinese_of(text);
    const auto hint = ethercat::al_status_hint(status);
    if (!hint.empty()) {
      append(text, hint, "; ");
      append(text_zh, chinese_of(hint), "；");
    }
    out.rows.push_back({{std::move(cell)}, std::move(text), std::move(text_zh), {}});
  };
  for (const auto status : ethercat::al_status_codes()) row(formatted("0x{:04X}", status), status);
  row(formatted("0x{:04X}-0xFFFF", ethercat::kFirstOfVendor), ethercat::kFirstOfVendor);
  return out;
}

}  // namespace servoctl::show
