// Foreign text on its way to a terminal, into JSON and into a table.
#include "base/printable.hpp"
#include "base/csv.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "report/value.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace servoctl;

namespace {

/// Nothing in it moves the cursor, turns the text around or hides.
bool is_clean(std::string_view text, bool lines) {
  while (!text.empty()) {
    const auto c = decode_utf8(text);
    const bool ours = lines && (text.front() == '\n' || text.front() == '\t');
    if (!c.value || (is_hidden_or_control(*c.value) && !ours)) return false;
    text.remove_prefix(c.size);
  }
  return true;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text(data, size);
  const auto shown = printable(text);
  fuzz::require(is_clean(shown, false), "what is printable is clean");
  fuzz::require(printable(shown) == shown, "what is clean stays as it is");
  fuzz::require(!is_clean(text, false) || shown == text, "clean text stays as it is");
  const auto lines = printable_lines(text);
  fuzz::require(is_clean(lines, true), "lines are clean but for what ends them");
  fuzz::require(printable_lines(lines) == lines, "clean lines stay as they are");
  (void)display_width(shown);
  fuzz::require(display_width(clip(shown, 20)) <= 20, "what is clipped fits");

  const auto json = report::to_json(report::Value(text));
  fuzz::require(is_clean(json, false), "JSON can be shown");
  const auto back = report::parse_json(json, "fuzz.json");
  fuzz::require(back.has_value(), "JSON can be read");
  const auto* string = std::get_if<std::string>(&back->data());
  fuzz::require(string != nullptr, "a text is a text");
  fuzz::require(!is_utf8(text) || *string == text, "JSON carries the true text");

  const auto cell = csv_cell(text);
  const auto table = parse_csv("first,second\nx," + cell + "\n", "fuzz.csv");
  fuzz::require(table && table->rows.size() == 1 && table->rows.front().cells[1] == text,
                "a cell comes back");
  return 0;
}
