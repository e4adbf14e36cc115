#include "command/man_page.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "command/roff.hpp"
#include "show/explanation.hpp"

namespace servoctl::command {
namespace {

std::string bold(std::string_view text) { return "\\fB" + roff_literal(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + roff_literal(text) + "\\fR"; }

std::string tagged(const std::string& tag, std::string_view text) {
  return ".TP\n" + tag + "\n" + roff_text(text);
}

std::string section(std::string_view name) { return fmt::format(".SH {}\n", name); }

std::string parameter_tag(const Parameter& parameter) {
  if (!parameter.name.starts_with("-")) return italic(value_word(parameter));
  auto out = parameter.short_name.empty() ? std::string() : bold(parameter.short_name) + ", ";
  out += bold(parameter.name);
  return parameter.kind == Kind::flag ? out : out + " " + italic(value_word(parameter));
}

std::string parameter_rows(std::span<const Parameter> parameters) {
  std::string out;
  for (const auto& parameter : parameters) out += tagged(parameter_tag(parameter), parameter.help);
  return out;
}

/// `before`: what stands before each line where it is typed.
std::string example_rows(std::string_view before, std::span<const Example> examples) {
  std::string out;
  for (const auto& example : examples)
    out += tagged(bold(fmt::format("{}{}", before, example.line)), example.what);
  return out.empty() ? out : ".PP\nExamples:\n" + out;
}

std::string word_part(const PromptWord& word) {
  return fmt::format(".SS {}{}\n", bold(word.name),
                     roff_literal(prompt_usage(word).substr(word.name.size()))) +
         roff_text(fmt::format("{}.", word.summary)) + ".PP\n" + roff_text(word.details) +
         example_rows({}, word.examples);
}

std::string command_part(const Command& command) {
  const auto line = usage_line(command.path);
  auto out = fmt::format(".SS {}{}\n", bold(command.path), roff_literal(line.substr(command.path.size())));
  out += roff_text(fmt::format("{}.", command.summary));
  if (!command.details.empty()) out += ".PP\n" + roff_text(command.details);
  return out + parameter_rows(command.parameters) + example_rows("servoctl ", command.examples);
}

std::string entries(std::span<const Entry> all) {
  std::string out;
  for (const auto& entry : all) out += tagged(bold(entry.name), entry.text);
  return out;
}

std::string exit_status() {
  std::string out;
  for (const auto& row : show::exit_code_topic().rows)
    out += tagged(bold(row.cells[0]),
                  row.cells[1].empty() ? row.text + "." : fmt::format("{}: {}.", row.cells[1], row.text));
  return out + ".PP\n" +
         roff_text(
             "The words are `error.code` in the document of `--json`. `servoctl explain exit` lists them too.");
}

std::string description() {
  return roff_text(
             "servoctl commissions servo drives that speak CANopen, on CAN or over EtherCAT, and reads and writes "
             "the parameters of some that speak Modbus. It finds and identifies the drives on a bus, changes "
             "parameters by their numbers in the manual, shows states and faults and what to do, saves, compares "
             "and restores settings, maps PDOs, and turns motors for a test.") +
         ".PP\n" +
         roff_text(
             "With a command it runs that and ends. Without one it is a prompt with history and completion, where "
             "`use NODE`, `drive FAMILY` and `bus BUS` hold for the following lines and `exit` ends it. Command lines "
             "from a pipe are run in the same way; the first one that fails ends them. `-` reads a batch file from "
             "standard input.") +
         ".PP\n" +
         roff_text(
             "What stores all values, restores, resets or moves is asked for on a terminal and needs `--yes` elsewhere. What "
             "stands behind `--` is a value, whatever it looks like: `write 607Ch -- -5`.") +
         ".PP\n" +
         roff_text(
             "This page is made from the tables by which the program reads its command line. `servoctl help COMMAND` "
             "shows the part on one command, `servoctl explain WORD` what an object, a parameter, a fault or a code means.");
}

std::string head(std::string_view version, std::string_view date) {
  return fmt::format(
             ".\\\" Written by `servoctl man`.\n.TH SERVOCTL 1 \"{}\" \"servoctl {}\" \"User Commands\"\n"
             ".nh\n.ad l\n",
             date, roff_literal(version)) +
         section("NAME") + "servoctl \\- commission CANopen servo drives from a terminal\n" +
         section("SYNOPSIS") +
         "\\fBservoctl\\fR [\\fIOPTIONS\\fR] \\fICOMMAND\\fR ...\n.br\n"
         "\\fBservoctl\\fR [\\fIOPTIONS\\fR]\n.br\n"
         "\\fBservoctl\\fR [\\fIOPTIONS\\fR] \\fB\\-\\fR\n.br\n"
         "\\fBservoctl \\-\\-version\\fR\n";
}

}  // namespace

std::string man_page(std::string_view version, std::string_view date) {
  auto out =
      head(version, date) + section("DESCRIPTION") + description() + section("GLOBAL OPTIONS") +
      roff_text("They stand before or behind the command.") + parameter_rows(global_options()) +
      section("COMMANDS") +
      roff_text(
          "Where an example has no `-b`, the bus is that of `SERVOCTL_BUS`, of the cabinet file or of the prompt, at "
          "which the word servoctl is left out.");
  for (const auto* command : registry()) out += command_part(*command);
  out += section("WORDS OF THE PROMPT");
  for (const auto& word : prompt_words()) out += word_part(word);
  out += section("BUSES") + roff_text("What `--bus` takes. A real bus is named in one of these forms:") +
         entries(manual_buses());
  out += section("EXIT STATUS") + exit_status() + section("ENVIRONMENT") + entries(manual_environment()) +
         section("FILES") + entries(manual_files()) + section("EXAMPLES") + entries(manual_examples()) +
         section("SEE ALSO");
  return out + "\\fBcandump\\fR(1),\n\\fBip\\-link\\fR(8),\n\\fBsetcap\\fR(8)\n.PP\n" +
         roff_text(
             "The README and the folder docs of servoctl go further: buses and adapters, EtherCAT, Modbus, "
             "motion, cabinet files, JSON, the data of drives.");
}

}  // namespace servoctl::command
