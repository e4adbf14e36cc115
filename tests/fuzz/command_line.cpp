// A line as it is typed: split, parsed, completed; its words as objects and values of a real drive.
#include <array>
#include <filesystem>

#include "cli/parse.hpp"
#include "cli/settings.hpp"
#include "cli/terminal/completer.hpp"
#include "cli/words.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "tests/cli/recording_console.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/source_dir.hpp"

using namespace servoctl;

namespace {

const drive::Profile& profile() {
  static const std::array folders{std::filesystem::path(source_dir()) / "eds"};
  static const auto loaded = drive::load_profile("gsd600", folders).value();
  return loaded;
}

void try_value(const std::string& name, const std::string& value) {
  const auto target = drive::resolve(&profile(), name);
  if (!target) return;
  const auto meaning = drive::meaning(*target, 1);
  const auto parsed = drive::parse_quantity(meaning, value);
  if (!parsed) return;
  const auto bytes = od::encode(meaning.type, *parsed);
  fuzz::require(bytes.has_value(), "a value that was accepted can be sent");
  const auto again = od::decode(meaning.type, *bytes);
  fuzz::require(again.has_value() && od::encode(meaning.type, *again).value() == *bytes,
                "what is sent can be read");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto line = fuzz::text(data, size);
  cli::RecordingConsole console;
  cli::Shell shell(console, {});
  (void)cli::complete(line, shell);
  const auto words = cli::split_words(line);
  if (!words) return 0;
  for (std::size_t i = 0; i + 1 < words->size(); ++i) try_value((*words)[i], (*words)[i + 1]);
  for (const auto& word : *words) {
    const auto nodes = cli::parse_nodes(word);
    if (!nodes) continue;
    for (const auto node : *nodes) fuzz::require(node <= 127, "a node-ID is at most 127");
  }
  if (const auto parsed = cli::parse_line(*words)) (void)cli::apply_options({}, parsed->arguments);
  return 0;
}
