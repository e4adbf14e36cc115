// A table of faults as people have it, made into one of a family.
#include <algorithm>
#include <array>

#include "base/csv.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "drive/fault.hpp"
#include "drive/foreign_cells.hpp"
#include "drive/foreign_heading.hpp"
#include "drive/foreign_table.hpp"
#include "drive/foreign_words.hpp"

namespace servoctl::drive {
namespace {

constexpr std::string_view kCodeExact[] = {"603fh", "603f", "0x603f", "emcy", "canopen"};
constexpr std::string_view kCodeMarks[] = {"0x603f", "603fh", "603f", "emcy", "canopen", "can"};
/// The code of 603Fh as well as what the panel shows: the former, unless another column is named for it.
constexpr std::string_view kCodeLoose[] = {"code",     "errorcode", "faultcode", "errcode", "错误码",
                                           "错误代码", "故障码",    "故障代码",  "报警码"};
constexpr std::string_view kPanelExact[] = {"panel",    "display",  "alarm",    "alarmno", "alarmcode",
                                            "faultno",  "面板",     "面板显示", "显示",    "报警号",
                                            "报警编号", "报警代码", "故障编号", "故障号"};
constexpr std::string_view kPanelLoose[] = {"no",        "number",    "id",      "编号",   "代码",
                                            "errorcode", "faultcode", "errcode", "错误码", "错误代码",
                                            "故障码",    "故障代码",  "报警码"};
constexpr std::string_view kExtraExact[] = {"extra", "subcode", "辅助码", "子码", "内部码"};
constexpr std::string_view kFaultKindExact[] = {"kind", "type", "level", "category", "类型", "类别", "级别"};
constexpr std::string_view kResettableExact[] = {
    "resettable", "reset", "clearable", "canbereset", "可复位", "复位", "是否可复位", "可清除", "能否复位"};
constexpr std::string_view kFaultNameExact[] = {"name",     "faultname", "alarmname", "名称",
                                                "故障名称", "报警名称",  "英文名称"};
constexpr std::string_view kFaultNameLoose[] = {"fault", "error",    "description", "meaning", "内容", "故障",
                                                "报警",  "报警内容", "故障内容",    "说明",    "描述"};
constexpr std::string_view kFaultNameZhExact[] = {"namezh", "中文", "中文名", "中文名称", "chinese"};
constexpr std::string_view kCauseExact[] = {"cause", "causes",   "reason",   "possiblecause",
                                            "原因",  "故障原因", "可能原因", "产生原因"};
constexpr std::string_view kCheckExact[] = {"check",    "remedy",         "action", "measure",  "measures",
                                            "solution", "countermeasure", "处理",   "处理方法", "处理措施",
                                            "解决方法", "对策",           "检查"};
constexpr std::string_view kCheckZhExact[] = {"checkzh"};

constexpr auto kFaultHeadings = std::to_array<Heading>({{"code", kCodeExact, kCodeLoose, true, kCodeMarks},
                                                        {"panel", kPanelExact, kPanelLoose},
                                                        {"extra", kExtraExact, {}, true},
                                                        {"kind", kFaultKindExact, {}},
                                                        {"resettable", kResettableExact, {}},
                                                        {"name", kFaultNameExact, kFaultNameLoose},
                                                        {"name_zh", kFaultNameZhExact, {}},
                                                        {"cause", kCauseExact, {}},
                                                        {"check", kCheckExact, {}},
                                                        {"check_zh", kCheckZhExact, {}}});

constexpr std::string_view kFaultHeader = "code,extra,panel,kind,resettable,name,name_zh,check,check_zh";

struct FaultRow {
  std::uint32_t line = 0;
  std::string code, extra, panel, kind, resettable, name, name_zh, check, check_zh;

  std::string csv() const {
    std::string out;
    bool first = true;
    for (const auto* cell : {&code, &extra, &panel, &kind, &resettable, &name, &name_zh, &check, &check_zh}) {
      out += (first ? "" : ",") + csv_cell(*cell);
      first = false;
    }
    return out + "\n";
  }
};

/// Whether the heading says that the codes are those of 603Fh.
bool is_canopen(std::string_view heading) {
  const auto text = lower(heading);
  return std::any_of(std::begin(kCodeMarks), std::end(kCodeMarks),
                     [&](auto mark) { return text.find(mark) != std::string::npos; });
}

/// Texts in Chinese are those of both languages.
void add_chinese(FaultRow& row) {
  if (row.name_zh.empty() && has_chinese(row.name)) row.name_zh = row.name;
  if (row.check_zh.empty() && has_chinese(row.check)) row.check_zh = row.check;
  if (row.name.empty()) row.name = row.name_zh;
}

class FaultConversion {
 public:
  FaultConversion(const ForeignTable& table, std::string_view file, std::vector<Error>& errors)
      : table_(&table), file_(file), errors_(&errors), canopen_(is_canopen(table.heading("code"))) {}

  ConvertedTable run() {
    for (const auto& cells : table_->rows())
      has_codes_ = has_codes_ || family_code(table_->cell(cells, "code"), false).has_value();
    for (const auto& cells : table_->rows()) take(cells);
    if (displayed_line_ != 0)
      out_.notices.push_back(message(
          "{}:{}: what column '{}' has without 0x or h is taken as what the panel shows; codes of 603Fh are "
          "written 0x8611",
          as_it_is(file_), displayed_line_, as_it_is(table_->heading("code"))));
    auto aligned = std::string(kFaultHeader) + "\n";
    out_.csv = aligned;
    std::uint32_t line = 2;
    for (const auto& row : rows_) {
      for (; line < row.line; ++line) aligned += '\n';
      aligned += row.csv();
      ++line;
      out_.csv += row.csv();
    }
    out_.rows = rows_.size();
    (void)read_faults(aligned, file_, *errors_);
    return std::move(out_);
  }

 private:
  void take(const CsvTable::Row& cells) {
    const auto cell = [&](std::string_view column) { return table_->cell(cells, column); };
    if (ForeignTable::filled(cells) == 0) return;
    if (ForeignTable::is_title(cells)) {
      out_.notices.push_back(
          message("{}:{}: left out: a line with its first cell alone", as_it_is(file_), cells.line));
      return;
    }
    FaultRow row{cells.line,
                 {},
                 cell("extra"),
                 cell("panel"),
                 family_kind(cell("kind")),
                 family_answer(cell("resettable")),
                 cell("name"),
                 cell("name_zh"),
                 cell("cause"),
                 cell("check_zh")};
    take_code(row, cell("code"));
    if (const auto remedy = cell("check"); !remedy.empty()) append(row.check, remedy, "; ");
    add_chinese(row);
    rows_.push_back(std::move(row));
  }

  /// The code of 603Fh, or what the panel shows where people put that into the column of codes.
  void take_code(FaultRow& row, const std::string& text) {
    if (text.empty()) return;
    if (const auto code = family_code(text, false)) {
      row.code = *code;
    } else if (canopen_) {
      row.code = text;  // The reader says what is wrong.
    } else if (!row.panel.empty()) {
      wrong(
          row.line,
          message("'{}' is no code of 603Fh, and the panel shows '{}'", as_it_is(text), as_it_is(row.panel)),
          "write the code as 0x8611");
    } else if (may_be_code(text)) {
      wrong(row.line, message("'{}' may be a code of 603Fh or what the panel shows", as_it_is(text)),
            "write one code in a row, as 0x8611; write what the panel shows into a column 'panel'");
    } else {
      row.panel = text;
      if (displayed_line_ == 0) displayed_line_ = row.line;
    }
  }

  /// Something with 0x, or four digits beside codes that are written with 0x or h.
  bool may_be_code(const std::string& text) const {
    return lower(text).find("0x") != std::string::npos || (has_codes_ && family_code(text, true).has_value());
  }

  void wrong(std::uint32_t line, const Message& what, Message hint) {
    errors_->push_back(file_error(file_, line, what, std::move(hint)));
  }

  const ForeignTable* table_;
  std::string_view file_;
  std::vector<Error>* errors_;
  bool canopen_;
  bool has_codes_ = false;  ///< Some are written with 0x or h.
  std::vector<FaultRow> rows_;
  std::uint32_t displayed_line_ = 0;
  ConvertedTable out_;
};

}  // namespace

ConvertedTable convert_faults(std::string_view bytes, std::string_view file, std::vector<Error>& errors) {
  const auto before = errors.size();
  const ForeignTable table(bytes, file, kFaultHeadings, errors);
  const auto heading = folded_heading(table.heading("panel"));
  const bool loose =
      std::find(std::begin(kPanelLoose), std::end(kPanelLoose), heading) != std::end(kPanelLoose);
  if (errors.size() == before && loose && table.counts_rows("panel"))
    errors.push_back(
        file_error(file, table.heading_line(),
                   message("the column '{}' counts the rows: 1, 2, 3", as_it_is(table.heading("panel"))),
                   "remove it; name it 'panel' if the panel shows these numbers"));
  if (errors.size() != before) return {};
  auto out = FaultConversion(table, file, errors).run();
  table.finish(file, before, errors, out);
  return out;
}

}  // namespace servoctl::drive
