#include "cli/restriction.hpp"

#include <algorithm>
#include <span>
#include <system_error>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/output_form.hpp"
#include "od/data_sheet.hpp"
#include "session/open_bus.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using command::Kind;

/// Where the file is, or would be made: without links, also where the last one leads to nothing.
fs::path real_place(fs::path file) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  for (int links = 0; links < kMostLinks && fs::is_symlink(file, error); ++links)
    file = file.parent_path() / fs::read_symlink(file, error);
  return fs::weakly_canonical(fs::absolute(file, error), error);
}

bool is_below(const fs::path& file, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end() && rest != file.end();
}

/// `diff` and `verify` take these in place of a file.
bool is_no_file(std::string_view word) { return word == "factory" || word.starts_with("node:"); }

/// It serves a bus to others, or changes an interface of this machine.
bool leaves_bus(const command::Command& command, const command::Arguments& arguments) {
  return command.opens_bus || command.path == "gateway" ||
         command.effect_with(arguments) == command::Effect::links;
}

constexpr std::string_view kWay = "read the file first; without --restricted it is allowed";

}  // namespace

Restriction::Restriction(const fs::path& folder, const std::vector<std::string>& buses) {
  std::error_code error;
  folder_ = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  for (const auto& bus : buses) buses_.push_back(session::canonical_url(bus));
}

Result<void> Restriction::check_bus(std::string_view url) const {
  const auto wanted = session::canonical_url(url);
  if (std::find(buses_.begin(), buses_.end(), wanted) != buses_.end()) return {};
  if (buses_.empty())
    return fail(Errc::refused,
                message("--restricted: the run was given no bus, and a line names {}", as_it_is(url)),
                "give the run its bus: run FILE --restricted --bus BUS");
  return fail(Errc::refused,
              message("--restricted allows no other bus than {}: {}", one_of(buses_), as_it_is(url)),
              std::string(kWay));
}

Result<void> Restriction::check_file(const fs::path& file) const {
  if (!folder_.empty() && is_below(real_place(file), folder_)) return {};
  return fail(Errc::refused,
              message("--restricted allows no file outside of {}: {}", as_it_is(folder_.string()),
                      as_it_is(file.string())),
              std::string(kWay));
}

Result<void> Restriction::check_family(std::string_view family) const {
  if (family.find_first_of("/.") == std::string_view::npos) return {};
  return check_file(od::sheet_name(family).path);
}

Result<void> Restriction::check_words(const command::Command& command,
                                      const command::Arguments& arguments) const {
  if (leaves_bus(command, arguments))
    return fail(Errc::refused, message("--restricted does not allow '{}'", as_it_is(command.path)),
                std::string(kWay));
  if (arguments.has("--cabinet"))
    return fail(Errc::refused, "--restricted allows no line to name a cabinet file",
                "give it to the run: run FILE --restricted --cabinet CABINET");
  for (const auto parameters : {command.parameters, command::global_options()})
    for (const auto& parameter : parameters)
      for (const auto& word : arguments.all(parameter.name)) {
        const bool form = parameter.name == "--output" && command::is_output_form(word);
        Result<void> right;
        if (parameter.kind == Kind::family) right = check_family(word);
        if (parameter.kind == Kind::file && !form && !is_no_file(word)) right = check_file(word);
        if (!right) return right;
      }
  // It makes a file in this folder where none is named.
  return command.path == "cabinet init" && !arguments.has("file") ? check_file("cabinet.toml")
                                                                  : Result<void>();
}

}  // namespace servoctl::cli
