#include "drive/family_mistakes.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "drive/everyday_words.hpp"
#include "drive/family_files.hpp"
#include "drive/parameter_ids.hpp"
#include "drive/profile_sheet.hpp"
#include "drive/topics.hpp"
#include "od/data_sheet.hpp"

namespace servoctl::drive {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kSheets[] = {".eds", ".dcf", ".xml"};
constexpr std::string_view kFileEnds[] = {".toml",        ".eds",         ".dcf",
                                          ".xml",         ".params.csv",  ".faults.csv",
                                          ".objects.csv", ".topics.toml", ".words.csv"};

/// Reads the files of one family, each as far as it can be read.
class FamilyCheck {
 public:
  FamilyCheck(const Family& family, std::span<const fs::path> folders)
      : family_(&family), folders_(folders) {}

  std::vector<Mistake> take() {
    profile_.family = family_->name;
    rules();
    sheet();
    tables();
    if (has_rules_) {
      check_rule_names(rules_text_, name_of(".toml"), profile_, errors_);
      note_errors(name_of(".toml"));
    }
    other_files();
    whole();
    return std::move(out_);
  }

 private:
  fs::path path_of(std::string_view end) const { return family_->stem.string() + std::string(end); }
  std::string name_of(std::string_view end) const { return path_of(end).filename().string(); }

  /// The text of a file, empty where there is none or it cannot be used.
  std::optional<std::string> text_of(std::string_view end) {
    std::error_code ignored;
    const auto path = path_of(end);
    if (!fs::exists(path, ignored)) return std::nullopt;
    const auto trusted = check_family_file(path);
    auto text = trusted ? read_file(path) : fail(trusted.error());
    if (!text) {
      errors_.push_back(text.error());
      note_errors(path.filename().string());
      return std::nullopt;
    }
    if (!is_utf8(*text) && !is_sheet(end)) {
      errors_.push_back(file_error(path.filename().string(), line_of_foreign(*text), "this is not UTF-8",
                                   "save the file as UTF-8 (in a spreadsheet: \"CSV UTF-8\")"));
      note_errors(path.filename().string());
      return std::nullopt;
    }
    return std::move(*text);
  }

  static bool is_sheet(std::string_view end) {
    return std::find(std::begin(kSheets), std::end(kSheets), end) != std::end(kSheets);
  }

  static std::uint32_t line_of_foreign(std::string_view text) {
    std::uint32_t line = 1;
    for (const auto part : split(text, '\n')) {
      if (!is_utf8(part)) break;
      ++line;
    }
    return line;
  }

  /// What was found in one file, by line.
  void note_errors(const std::string& file) {
    std::stable_sort(errors_.begin(), errors_.end(),
                     [](const Error& a, const Error& b) { return a.line.value_or(0) < b.line.value_or(0); });
    for (auto& error : errors_)
      out_.push_back({file, error.line, true, std::move(error.message), std::move(error.hint)});
    errors_.clear();
  }

  void rules() {
    auto text = text_of(".toml");
    if (!text) return;
    const auto name = name_of(".toml");
    has_rules_ = true;
    rules_text_ = std::move(*text);
    if (const auto ends = check_parents(*family_, folders_); !ends) {
      errors_.push_back(ends.error());
    } else if (const auto parent = parent_of(rules_text_); !parent.empty()) {
      auto loaded = load_profile(parent, folders_);
      if (loaded)
        profile_ = std::move(*loaded);
      else
        errors_.push_back(make_error(loaded.error().code,
                                     message("{}: parent: {}", as_it_is(name), loaded.error().message),
                                     loaded.error().hint));
      profile_.family = family_->name;
    }
    profile_.rules = read_rules(rules_text_, name, std::move(profile_.rules), errors_);
    const auto& family = profile_.rules.family;
    if (!family.empty() && !equals_nocase(family, family_->name))
      errors_.push_back(make_error(Errc::file,
                                   message("{}: family = \"{}\"", as_it_is(name), as_it_is(family)),
                                   message("the files are called {0}.*: write family = \"{0}\", or rename "
                                           "them",
                                           as_it_is(family_->name))));
    note_errors(name);
  }

  void sheet() {
    bool used = false;
    for (const auto end : kSheets) {
      std::error_code ignored;
      const auto name = name_of(end);
      if (!fs::exists(path_of(end), ignored)) continue;
      if (std::exchange(used, true)) {
        out_.push_back({name, std::nullopt, false, message("{} is not used", as_it_is(name)),
                        message("one data sheet is used, the first of {0}.eds, {0}.dcf and {0}.xml",
                                as_it_is(family_->stem.filename().string()))});
        continue;
      }
      const auto text = text_of(end);
      if (text) sheet_text(*text, name);
    }
  }

  void sheet_text(const std::string& text, const std::string& name) {
    auto file = od::read_data_sheet(text, name);
    if (!file) {
      errors_.push_back(file.error());
      return note_errors(name);
    }
    for (const auto& finding : file->diagnostics)
      out_.push_back({name, finding.line, false,
                      message("{}:{}:{}: {}", as_it_is(name), finding.line, finding.column, finding.message),
                      finding.remedy});
    has_sheet_ = true;
    take_sheet(profile_, *file);
  }

  void tables() {
    if (const auto text = text_of(".objects.csv")) {
      od::annotate(profile_.dictionary, *text, name_of(".objects.csv"), errors_);
      note_errors(name_of(".objects.csv"));
    }
    if (const auto text = text_of(".params.csv")) {
      profile_.parameters = od::read_parameters(*text, name_of(".params.csv"), errors_);
      profile_.made_of_dictionary = false;
      refuse_same_ids(profile_.parameters, name_of(".params.csv"), errors_);
      for (const auto& parameter : profile_.parameters) compare_with_sheet(parameter);
      for (auto& one : shadowing_ids(profile_.parameters, profile_.dictionary, name_of(".params.csv")))
        out_.push_back(
            {name_of(".params.csv"), one.line, false, std::move(one.message), std::move(one.hint)});
      if (!errors_.empty()) add_names(*text);
      note_errors(name_of(".params.csv"));
    }
    profile_.build_index();
    if (const auto text = text_of(".faults.csv")) {
      (void)read_faults(*text, name_of(".faults.csv"), errors_);
      note_errors(name_of(".faults.csv"));
    }
    if (const auto text = text_of(".topics.toml")) {
      (void)read_topics(*text, name_of(".topics.toml"), family_->name, errors_);
      note_errors(name_of(".topics.toml"));
    }
    if (const auto text = text_of(".words.csv")) {
      (void)read_everyday_words(*text, name_of(".words.csv"), errors_);
      note_errors(name_of(".words.csv"));
    }
  }

  /// Of rows that are wrong the names exist all the same: the rules may use them.
  void add_names(const std::string& text) {
    std::vector<Error> known;
    const auto table = read_csv(text, {}, known);
    const auto column = table.column("id");
    if (column == table.columns.size()) return;
    for (const auto& row : table.rows) profile_.parameters.emplace_back().id = row.cells[column];
  }

  /// The wire has what the data sheet says: a parameter of another size would be written cut off.
  void compare_with_sheet(const od::Parameter& parameter) {
    if (!has_sheet_ || !parameter.object) return;
    const auto name = name_of(".params.csv");
    const auto* entry = profile_.dictionary.find(*parameter.object);
    const auto wrong = [&](const Message& what, Message hint) {
      errors_.push_back(file_error(name, parameter.file_line, what, std::move(hint)));
    };
    if (entry == nullptr) {
      const auto* object = profile_.dictionary.object(parameter.object->index);
      wrong(message("{}: object {} is not in the data sheet", as_it_is(parameter.id),
                    to_string(*parameter.object)),
            object == nullptr || object->entries.empty()
                ? Message("correct the object, or leave it empty if the bus does not reach the parameter")
                : message("0x{:04X} has the sub-indexes {} to {}", object->index,
                          object->entries.front().address.sub, object->entries.back().address.sub));
    } else if (entry->type != parameter.type) {
      wrong(message("{}: type {}, but {} is {} in the data sheet", as_it_is(parameter.id),
                    as_it_is(od::name(parameter.type)), to_string(*parameter.object),
                    as_it_is(od::name(entry->type))),
            message("write {} if the data sheet is right", as_it_is(od::name(entry->type))));
    }
  }

  /// A file with a misspelt name would silently be missing.
  void other_files() {
    const auto stem = family_->stem.filename().string();
    std::error_code error;
    std::vector<std::string> names;
    for (fs::directory_iterator it(family_->stem.parent_path(), error), end; !error && it != end;
         it.increment(error))
      names.push_back(it->path().filename().string());
    std::sort(names.begin(), names.end());
    std::vector<std::string> known;
    for (const auto end : kFileEnds) known.push_back(stem + std::string(end));
    for (const auto& name : names)
      if (name.starts_with(stem + ".") && std::find(known.begin(), known.end(), name) == known.end())
        out_.push_back({name, std::nullopt, false, message("{} is not read", as_it_is(name)),
                        did_you_mean(name, known)});
  }

  /// What only the whole family shows.
  void whole() {
    if (count_errors(out_) > 0) return;
    const auto loaded = load_profile(*family_, folders_);
    if (!loaded)
      out_.push_back({family_->stem.filename().string() + ".*", loaded.error().line, true,
                      loaded.error().message, loaded.error().hint});
  }

  const Family* family_;
  std::span<const fs::path> folders_;
  Profile profile_;
  std::string rules_text_;
  bool has_rules_ = false;
  bool has_sheet_ = false;
  std::vector<Error> errors_;  ///< Of the file that is being read.
  std::vector<Mistake> out_;
};

}  // namespace

std::vector<Mistake> mistakes_of(const Family& family, std::span<const fs::path> folders) {
  return FamilyCheck(family, folders).take();
}

std::size_t count_errors(std::span<const Mistake> mistakes) {
  return static_cast<std::size_t>(
      std::count_if(mistakes.begin(), mistakes.end(), [](const Mistake& mistake) { return mistake.breaks; }));
}

}  // namespace servoctl::drive
