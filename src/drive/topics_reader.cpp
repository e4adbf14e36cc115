// `<family>.topics.toml`, key by key.
#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "base/folded.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/toml_depth.hpp"
#include "drive/toml_reader.hpp"
#include "drive/topics.hpp"

namespace servoctl::drive {
namespace {

constexpr std::array<std::string_view, 15> kTopicKinds{"wiring", "connector", "cable",     "panel",  "led",
                                                       "state",  "mode",      "homing",    "bits",   "input",
                                                       "output", "signal",    "procedure", "preset", "term"};

class TopicsReader {
 public:
  TopicsReader(std::string_view file, std::string_view family, std::vector<Error>& errors)
      : file_(file), family_(family), errors_(&errors) {}

  std::vector<Topic> read(const toml::table& root) {
    std::int64_t format = 0;
    (void)TableReader(root, file_, errors_)
        .read({{"format", [&](const auto& n) { return get_int(n, format) && format == 1; }},
               {"topic", [&](const auto& n) { return topics(n); }},
               {"words_zh", [&](const auto& n) { return words(n); }}});
    if (root.get("format") == nullptr && errors_->empty())
      errors_->push_back(make_error(Errc::file, message("{}: 'format' is missing", as_it_is(file_)),
                                    "begin the file with format = 1"));
    for (auto& topic : topics_) give_words(topic);
    return std::move(topics_);
  }

 private:
  using Words = std::vector<std::pair<std::string, std::string>>;

  bool words(const toml::node& node) {
    const auto* table = node.as_table();
    if (table == nullptr) return false;
    for (const auto& [key, value] : *table) {
      std::string chinese;
      if (!drive::get(value, chinese) || chinese.empty()) return false;
      words_.emplace_back(std::string(key.str()), std::move(chinese));
    }
    std::stable_sort(words_.begin(), words_.end(),
                     [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
    return true;
  }

  void give_words(Topic& topic) const {
    const auto is_cell = [&](const std::string& word) {
      return std::any_of(topic.rows.begin(), topic.rows.end(), [&](const TopicRow& row) {
        return std::find(row.cells.begin(), row.cells.end(), word) != row.cells.end();
      });
    };
    for (const auto& word : words_)
      if (topic.picture.find(word.first) != std::string::npos || is_cell(word.first))
        topic.words_zh.push_back(word);
  }

  bool topics(const toml::node& node) {
    const auto* array = node.as_array();
    if (array == nullptr) return false;
    for (const auto& element : *array) {
      const auto* table = element.as_table();
      if (table == nullptr) return false;
      (void)topic(*table);
    }
    return true;
  }

  Result<void> topic(const toml::table& table) {
    Topic out;
    out.family = family_;
    const TableReader reader(table, file_, errors_);
    // Each row is held against them, wherever they stand.
    if (const auto* columns = table.get("columns")) (void)drive::get(*columns, out.columns);
    const auto source = [](std::string& line) {
      return [&line](const toml::node& n) { return drive::get(n, line) && is_source_line(line); };
    };
    const auto kind = [&](const toml::node& n) {
      return drive::get(n, out.kind) &&
             std::find(kTopicKinds.begin(), kTopicKinds.end(), out.kind) != kTopicKinds.end();
    };
    const auto network = [&](const toml::node& n) {
      return drive::get(n, out.network) && (out.network == "can" || out.network == "ethercat");
    };
    const auto done = reader.read({{"kind", kind},
                                   {"name", into(out.name)},
                                   {"also", into(out.also)},
                                   {"title", into(out.title)},
                                   {"title_zh", into(out.title_zh)},
                                   {"text", into(out.text)},
                                   {"text_zh", into(out.text_zh)},
                                   {"columns", into(out.columns)},
                                   {"columns_zh", into(out.columns_zh)},
                                   {"rows", [&](const auto& n) { return rows(n, out); }},
                                   {"picture", into(out.picture)},
                                   {"note", into(out.note)},
                                   {"note_zh", into(out.note_zh)},
                                   {"assumed", into(out.assumed)},
                                   {"figure", into(out.figure)},
                                   {"object", into(out.object)},
                                   {"value", into(out.value)},
                                   {"network", network},
                                   {"mode", into(out.mode)},
                                   {"line", source(out.line)}},
                                  {{"kind", kKindForm},
                                   {"line", kLineForm},
                                   {"object", R"("0x6098:00")"},
                                   {"network", "can or ethercat"}});
    if (!done) return done;
    if (const auto whole = check(table, out); !whole) return whole;
    topics_.push_back(std::move(out));
    return {};
  }

  bool rows(const toml::node& node, Topic& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return false;
    for (const auto& element : *array) {
      const auto* table = element.as_table();
      if (table == nullptr) return false;
      (void)row(*table, out.columns.size(), out.rows.emplace_back());
    }
    return true;
  }

  Result<void> row(const toml::table& table, std::size_t columns, TopicRow& out) const {
    const TableReader reader(table, file_, errors_);
    const auto line = [&](const toml::node& n) {
      return drive::get(n, out.line) && is_source_line(out.line);
    };
    if (const auto done = reader.read({{"cells", into(out.cells)},
                                       {"text", into(out.text)},
                                       {"text_zh", into(out.text_zh)},
                                       {"line", line}},
                                      {{"line", kLineForm}});
        !done)
      return done;
    if (out.cells.size() != columns)
      return reader.fail_at(table,
                            formatted("a row of {} 'cells' under {} 'columns'", out.cells.size(), columns));
    if (out.line.empty()) return reader.fail_at(table, "a row without 'line'");
    if (out.text.empty() != out.text_zh.empty())
      return reader.fail_at(table, "a row has both 'text' and 'text_zh', or neither");
    return {};
  }

  Result<void> check(const toml::table& table, const Topic& topic) {
    const TableReader reader(table, file_, errors_);
    const auto wrong = [&](const Message& what) {
      return reader.fail_at(
          table, topic.name.empty() ? what : message("topic '{}': {}", as_it_is(topic.name), what));
    };
    for (const auto& [key, value] :
         {std::pair("kind", &topic.kind), std::pair("name", &topic.name), std::pair("title", &topic.title),
          std::pair("title_zh", &topic.title_zh), std::pair("line", &topic.line)})
      if (trim(*value).empty()) return wrong(message("'{}' is missing", as_it_is(key)));
    for (const auto& [key, one, other] :
         {std::tuple("text", &topic.text, &topic.text_zh), std::tuple("note", &topic.note, &topic.note_zh)})
      if (one->empty() != other->empty())
        return wrong(message("'{0}' and '{0}_zh' go together", as_it_is(key)));
    if (topic.text.empty() && topic.rows.empty() && topic.picture.empty())
      return wrong("it says nothing: 'text', 'rows' or 'picture' is missing");
    if (topic.value && !topic.object) return wrong("'value' needs 'object'");
    if (!names_.insert(folded(topic.name)).second) return wrong("its name appears twice in the file");
    if (topic.columns.empty() != topic.rows.empty()) return wrong("'columns' and 'rows' go together");
    if (topic.columns_zh.size() != topic.columns.size())
      return wrong(
          message("{} 'columns', but {} 'columns_zh'", topic.columns.size(), topic.columns_zh.size()));
    return {};
  }

  static constexpr std::string_view kLineForm = R"(line = "6692-6711 6801", or a clause: "CiA 301, 7.3.2")";
  static constexpr std::string_view kKindForm =
      "wiring, connector, cable, panel, led, state, mode, homing, bits, input, output, signal, procedure, preset "
      "or term";

  std::string_view file_;
  std::string family_;
  std::vector<Topic> topics_;
  Words words_;
  std::set<std::string> names_;
  std::vector<Error>* errors_;
};

}  // namespace

std::span<const std::string_view> topic_kinds() { return kTopicKinds; }

bool is_source_line(std::string_view text) {
  if (text.empty()) return false;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (!is_digit(text.front())) return (lower(text).front() >= 'a' && lower(text).front() <= 'z');
  for (const auto part : split(text, ' ')) {
    const auto dash = part.find('-');
    const auto first = parse_digits(part.substr(0, dash), 10);
    const auto last = dash == std::string_view::npos ? first : parse_digits(part.substr(dash + 1), 10);
    if (!first || !last || *first == 0 || *last < *first) return false;
  }
  return true;
}

std::vector<Topic> read_topics(std::string_view toml, std::string_view file, std::string_view family,
                               std::vector<Error>& errors) {
  if (const auto flat = check_toml_depth(toml, file); !flat) {
    errors.push_back(flat.error());
    return {};
  }
  const auto parsed = toml::parse(toml, file);
  if (parsed) return TopicsReader(file, family, errors).read(parsed.table());
  const auto at = parsed.error().source().begin;
  errors.push_back(file_error(file, at.line, at.column, parsed.error().description()));
  return {};
}

Result<std::vector<Topic>> parse_topics(std::string_view toml, std::string_view file,
                                        std::string_view family) {
  std::vector<Error> errors;
  auto out = read_topics(toml, file, family, errors);
  if (!errors.empty()) return fail(std::move(errors.front()));
  return out;
}

}  // namespace servoctl::drive
