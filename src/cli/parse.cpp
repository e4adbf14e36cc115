#include "cli/parse.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <map>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "cli/unknown_command.hpp"
#include "command/help_text.hpp"
#include "command/registry.hpp"

namespace servoctl::cli {
namespace {

using command::Command;
using command::Kind;
using command::Parameter;

const Parameter* global_option(std::string_view word) {
  const auto name = word.substr(0, word.find('='));
  for (const auto& option : command::global_options())
    if (option.name == name || (!option.short_name.empty() && option.short_name == name)) return &option;
  return nullptr;
}

/// Number of words of `path` that stand in `words` from `first` on; 0 when one differs.
std::size_t words_that_fit(std::string_view path, const std::vector<std::string>& words, std::size_t first) {
  std::size_t used = 0;
  while (!path.empty()) {
    const auto word = path.substr(0, path.find(' '));
    if (first + used >= words.size() || words[first + used] != word) return 0;
    ++used;
    path.remove_prefix(std::min(word.size() + 1, path.size()));
  }
  return used;
}

/// Position of the first word that is neither a global option nor its value.
std::size_t first_plain_word(const std::vector<std::string>& words) {
  std::size_t i = 0;
  while (i < words.size() && words[i].size() > 1 && words[i].front() == '-') {
    const auto* option = global_option(words[i]);
    const bool takes_next =
        option != nullptr && option->kind != Kind::flag && words[i].find('=') == std::string::npos;
    i += takes_next ? 2 : 1;
  }
  return std::min(i, words.size());
}

bool is_option(const Parameter& parameter) { return parameter.name.starts_with("-"); }

/// `FILE`, as the synopsis of `help` has it.
std::string as_in_help(const Parameter& parameter) {
  return is_option(parameter) ? std::string(parameter.name) : upper(parameter.name);
}

/// Whether the word can name the option: `--timeout`, `--timeout=2s`, `-n`, `-n3`, `-vj`.
bool can_name(std::string_view word, const Parameter& option) {
  if (word.size() < 2 || word.front() != '-') return false;
  if (word.substr(0, word.find('=')) == option.name) return true;
  return word[1] != '-' && !option.short_name.empty() && word.find(option.short_name.back()) != word.npos;
}

/// Every value stays text, because CLI11 reads "010" as 8 and refuses "6040h". What one line gave is
/// forgotten before the next is read. CLI11 knows the options that some line named: it compares each that is
/// added with all before it, a third of what a one-shot line costs.
class LineParser {
 public:
  explicit LineParser(const Command& command)
      : command_(&command), app_(std::string(command.summary), std::string(command.path)) {
    app_.set_help_flag();
    app_.allow_extras();
    for (const auto& parameter : command.parameters) bound_.push_back({&parameter, nullptr, {}});
    for (const auto& parameter : command::global_options())
      if (!command::has_own(command, parameter)) bound_.push_back({&parameter, nullptr, {}});
    for (auto& entry : bound_)
      if (!is_option(*entry.parameter)) bind(entry);
  }

  /// Behind the first `--` stand values of arguments, whatever they look like: CLI11 does not see them. Where
  /// no argument is left to take one, options may follow: `jog -- -30rpm --for 2s`.
  Result<command::Arguments> parse(std::vector<std::string> words) {
    const auto mark = std::find(words.begin(), words.end(), "--");
    std::vector<std::string> values(mark == words.end() ? mark : mark + 1, words.end());
    words.erase(mark, words.end());
    const auto room = values.empty() ? 0 : room_behind(words);
    if (room < values.size() && values[room].starts_with('-')) {
      words.insert(words.end(), values.begin() + static_cast<std::ptrdiff_t>(room), values.end());
      values.resize(room);
    }
    if (const auto taken = take_words(std::move(words)); !taken) return fail(taken.error());
    for (const auto& value : values)
      if (!take_argument(value)) return one_too_many(value);
    return collect();
  }

 private:
  struct Bound {
    const Parameter* parameter;
    CLI::Option* option;  ///< Null until a line names it.
    std::vector<std::string> values;

    bool is_given() const { return option != nullptr && option->count() > 0; }
  };

  /// An argument in capitals: CLI11 from 2.4 on takes an argument `b` and an option `-b` for the same.
  void bind(Bound& entry) {
    const auto& parameter = *entry.parameter;
    const auto names = parameter.short_name.empty()
                           ? as_in_help(parameter)
                           : formatted("{},{}", parameter.short_name, parameter.name);
    if (parameter.kind == Kind::flag) {
      entry.option = app_.add_flag(names);
      return;
    }
    entry.option =
        app_.add_option(names)
            ->expected(1, parameter.many ? CLI::detail::expected_max_vector_size : 1)
            ->multi_option_policy(parameter.many || parameter.repeats ? CLI::MultiOptionPolicy::TakeAll
                                                                      : CLI::MultiOptionPolicy::TakeLast)
            ->allow_extra_args(parameter.many);
  }

  void bind_those_named_in(const std::vector<std::string>& words) {
    for (auto& entry : bound_)
      if (entry.option == nullptr &&
          std::ranges::any_of(words, [&](const auto& word) { return can_name(word, *entry.parameter); }))
        bind(entry);
  }

  Result<void> take_words(std::vector<std::string> words) {
    app_.clear();
    for (auto& entry : bound_) entry.values.clear();
    bind_those_named_in(words);
    if (const auto whole = each_has_its_value(words); !whole) return whole;
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back.
    try {
      app_.parse(std::move(words));
    } catch (const CLI::ParseError& e) {
      return fail(Errc::usage, message("{}: {}", command_->path, e.what()), help_hint());
    }
    if (const auto rest = app_.remaining(); !rest.empty()) return superfluous(rest.front());
    take_results();
    return each_is_said_once();
  }

  /// Refuses an option that is given twice with two values.
  Result<void> each_is_said_once() const {
    for (const auto& [parameter, option, values] : bound_) {
      if (option == nullptr) continue;
      const auto& given = option->results();
      const bool every = parameter->kind == Kind::flag || parameter->many || parameter->repeats;
      if (every || given.empty() || std::ranges::count(given, given.front()) == std::ssize(given)) continue;
      return fail(Errc::usage,
                  message("{}: {} is given twice: {} and {}", command_->path, parameter->name,
                          as_it_is(given.front()), as_it_is(given.back())),
                  "leave one of them out");
    }
    return {};
  }

  const Parameter* option_named(std::string_view name) const {
    for (const auto& [parameter, option, values] : bound_)
      if (name.starts_with('-') && (parameter->name == name || parameter->short_name == name))
        return parameter;
    return nullptr;
  }

  /// Refuses an option whose value is missing, where the line ends or another option follows, and a switch
  /// with one: `--yes=no` would be a yes. `--to=--json` takes what looks like an option.
  Result<void> each_has_its_value(const std::vector<std::string>& words) const {
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto equals = words[i].find('=');
      const auto* option = option_named(std::string_view(words[i]).substr(0, equals));
      if (option == nullptr) continue;
      const bool has_value = equals != std::string::npos;
      if (option->kind == Kind::flag && has_value)
        return fail(Errc::usage, message("{}: {} takes no value", command_->path, option->name), help_hint());
      if (option->kind == Kind::flag || has_value) continue;
      if (i + 1 == words.size() || option_named(words[i + 1]) != nullptr)
        return fail(Errc::usage, message("{}: {} needs a value", command_->path, option->name),
                    message("{}: {}; {}", option->name, option->help, help_hint()));
      ++i;
    }
    return {};
  }

  /// How many words the arguments still take after these words.
  std::size_t room_behind(const std::vector<std::string>& words) {
    if (!take_words(words)) return 0;
    std::size_t room = 0;
    for (const auto& entry : bound_) {
      if (is_option(*entry.parameter)) continue;
      if (entry.parameter->many) return std::numeric_limits<std::size_t>::max();
      room += entry.values.empty() ? 1U : 0U;
    }
    return room;
  }

  /// The words as they were given: what CLI11 makes of them reads `{}` as nothing.
  void take_results() {
    for (auto& entry : bound_) {
      if (entry.parameter->kind == Kind::flag || !entry.is_given()) continue;
      const auto& all = entry.option->results();
      const bool every = entry.parameter->many || entry.parameter->repeats;
      entry.values.assign(every ? all.begin() : all.end() - 1, all.end());
    }
  }

  /// Gives the word to the first argument that still takes one.
  bool take_argument(const std::string& word) {
    for (auto& entry : bound_) {
      if (is_option(*entry.parameter)) continue;
      if (!entry.values.empty() && !entry.parameter->many) continue;
      entry.values.push_back(word);
      return true;
    }
    return false;
  }

  Result<command::Arguments> collect() const {
    command::Arguments out;
    for (const auto& entry : bound_) {
      const auto& parameter = *entry.parameter;
      if (entry.values.empty() && !entry.is_given()) {
        if (parameter.required)
          return fail(Errc::usage, message("{}: {} is missing", command_->path, as_in_help(parameter)),
                      message("{}: {}; {}", as_in_help(parameter), parameter.help, help_hint()));
        continue;
      }
      if (parameter.kind == Kind::flag) out.add(parameter.name, "true");
      for (const auto& value : entry.values) {
        if (parameter.kind == Kind::choice &&
            std::find(parameter.choices.begin(), parameter.choices.end(), value) == parameter.choices.end())
          return bad_choice(parameter, value);
        out.add(parameter.name, value);
      }
    }
    return out;
  }

  tl::unexpected<Error> bad_choice(const Parameter& parameter, const std::string& value) const {
    const std::vector<std::string> choices(parameter.choices.begin(), parameter.choices.end());
    return fail(
        Errc::usage,
        message("{}: '{}' is not valid for {}", command_->path, as_it_is(value), as_in_help(parameter)),
        message("write {}", one_of(choices)));
  }

  tl::unexpected<Error> one_too_many(const std::string& word) const {
    return fail(Errc::usage, message("{}: unexpected argument '{}'", command_->path, as_it_is(word)),
                help_hint());
  }

  tl::unexpected<Error> superfluous(const std::string& word) const {
    if (word.size() < 2 || word.front() != '-') return one_too_many(word);
    std::vector<std::string> known;
    for (const auto& entry : bound_)
      if (is_option(*entry.parameter)) known.emplace_back(entry.parameter->name);
    auto hint = did_you_mean(word, known);
    return fail(Errc::usage, message("{}: there is no option '{}'", command_->path, as_it_is(word)),
                hint.empty() ? help_hint() : hint);
  }

  std::string help_hint() const { return formatted("`help {}` shows how it is used", command_->path); }

  const Command* command_;
  CLI::App app_;
  std::vector<Bound> bound_;
};

/// Made once for each command: to bind its options takes CLI11 longer than to read a line of a batch.
LineParser& parser_of(const Command& command) {
  thread_local std::map<const Command*, LineParser> parsers;
  return parsers.try_emplace(&command, command).first->second;
}

}  // namespace

CommandMatch match_command(const std::vector<std::string>& words) {
  CommandMatch best;
  best.first = first_plain_word(words);
  const auto commands = command::registry();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto used = words_that_fit(command::registered_path(i), words, best.first);
    if (used > best.used) {
      best.command = commands[i];
      best.used = used;
    }
  }
  return best;
}

Result<void> check_options_alone(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& word = words[i];
    const auto* option = global_option(word);
    // `-n3` is `-n 3`.
    const bool joined = word.size() > 2 && word[1] != '-' && global_option(word.substr(0, 2)) != nullptr;
    if (option == nullptr && !joined && word.starts_with('-')) {
      std::vector<std::string> known;
      for (const auto& each : command::global_options()) known.emplace_back(each.name);
      return fail(Errc::usage, message("there is no option '{}'", as_it_is(word)), did_you_mean(word, known));
    }
    if (option != nullptr && option->kind != Kind::flag && word.find('=') == std::string::npos) ++i;
  }
  return {};
}

Result<ParsedLine> parse_line(const std::vector<std::string>& words) {
  const auto match = match_command(words);
  if (match.first == words.size()) {
    if (const auto known = check_options_alone(words); !known) return fail(known.error());
    return fail(Errc::usage, "a command is missing", "`help` lists the commands");
  }
  if (match.command == nullptr) return fail(unknown_command(words, match.first));
  auto rest = words;
  const auto begin = rest.begin() + static_cast<std::ptrdiff_t>(match.first);
  rest.erase(begin, begin + static_cast<std::ptrdiff_t>(match.used));
  const bool is_behind = match.first + match.used < words.size();
  const bool asks = match.command->path == "help" && is_behind && rest.back().starts_with('-');
  auto of_option = rest;
  if (asks) of_option.insert(of_option.end() - 1, "--");
  auto arguments = parser_of(*match.command).parse(std::move(rest));
  // `help --for`: about an option, where the line itself cannot have it.
  if (!arguments && asks) arguments = parser_of(*match.command).parse(std::move(of_option));
  if (!arguments) return fail(arguments.error());
  return ParsedLine{match.command, std::move(*arguments)};
}

bool asks_for_help(const std::vector<std::string>& words) {
  // Behind `--` stand values, whatever they look like.
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::any_of(words.begin(), end, [](const std::string& w) { return w == "--help" || w == "-h"; });
}

}  // namespace servoctl::cli
