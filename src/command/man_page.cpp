#include "command/man_page.hpp"

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/help_text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "command/roff.hpp"
#include "report/catalogue.hpp"
#include "show/explanation.hpp"

namespace servoctl::command {
namespace {

std::string bold(std::string_view text) { return "\\fB" + roff_literal(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + roff_literal(text) + "\\fR"; }

std::string parameter_tag(const Parameter& parameter) {
  if (!parameter.name.starts_with("-")) return italic(value_word(parameter));
  auto out = parameter.short_name.empty() ? std::string() : bold(parameter.short_name) + ", ";
  out += bold(parameter.name);
  return parameter.kind == Kind::flag ? out : out + " " + italic(value_word(parameter));
}

/// The parts of the page, in a language.
class ManPage {
 public:
  explicit ManPage(bool chinese) : chinese_(chinese) {}

  std::string head(std::string_view version, std::string_view date) const {
    return formatted(
               ".\\\" Written by `servoctl man`.\n.TH SERVOCTL 1 \"{}\" \"servoctl {}\" \"{}\"\n"
               ".nh\n.ad l\n.ds AD l\n",  // groff 1.23 adjusts each section anew, as AD says.
               date, roff_literal(version), roff_literal(said("User commands"))) +
           section("Name") + "servoctl \\- " + said("commission CANopen servo drives from a terminal") +
           "\n" + section("Synopsis") +
           "\\fBservoctl\\fR [\\fIOPTIONS\\fR] \\fICOMMAND\\fR ...\n.br\n"
           "\\fBservoctl\\fR [\\fIOPTIONS\\fR]\n.br\n"
           "\\fBservoctl\\fR [\\fIOPTIONS\\fR] \\fB\\-\\fR\n.br\n"
           "\\fBservoctl \\-\\-version\\fR\n";
  }

  std::string description() const {
    return section("Description") +
           text(
               "servoctl commissions servo drives that speak CANopen, on CAN or over EtherCAT, and reads and writes "
               "the parameters of some that speak Modbus. It finds and identifies the drives on a bus, changes "
               "parameters by their numbers in the manual, shows states and faults and what to do, saves, compares "
               "and restores settings, maps PDOs, and turns motors for a test.") +
           paragraph(
               "With a command it runs that and ends. Without one it is a prompt with history and completion, where "
               "`use NODE`, `drive FAMILY` and `bus BUS` hold for the following lines and `exit` ends it. Command lines "
               "from a pipe are run in the same way; the first one that fails ends them. `-` reads a batch file from "
               "standard input.") +
           paragraph(
               "What stores all values, restores, resets or moves is asked for on a terminal and needs `--yes` elsewhere. What "
               "stands behind `--` is a value, whatever it looks like: `write 607Ch -- -5`.") +
           paragraph(
               "This page is made from the tables by which the program reads its command line. `servoctl help COMMAND` "
               "shows the part on one command, `servoctl explain WORD` what an object, a parameter, a fault or a code means.");
  }

  std::string options() const {
    return section("Global options") + text("They stand before or behind the command.") +
           parameter_rows(global_options());
  }

  std::string commands() const {
    auto out =
        section("Commands") +
        text(
            "Where an example has no `-b`, the bus is that of `SERVOCTL_BUS`, of the cabinet file or of "
            "the prompt, at which the word servoctl is left out.");
    for (const auto* command : registry()) out += part(*command);
    out += section("Words of the prompt");
    for (const auto& word : prompt_words()) out += part(word);
    return out;
  }

  std::string tables() const {
    return section("Buses") + text("What `--bus` takes. A real bus is named in one of these forms:") +
           entries(manual_buses()) + section("Exit status") + exit_status() + section("Environment") +
           entries(manual_environment()) + section("Files") + entries(manual_files()) + section("Examples") +
           entries(manual_examples());
  }

  std::string end() const {
    return section("See also") + "\\fBcandump\\fR(1),\n\\fBip\\-link\\fR(8),\n\\fBsetcap\\fR(8)\n" +
           paragraph(
               "The README and the folder docs of servoctl go further: buses and adapters, EtherCAT, Modbus, "
               "motion, cabinet files, JSON, the data of drives.");
  }

 private:
  std::string said(std::string_view english) const {
    return chinese_ ? report::in_chinese(english) : std::string(english);
  }

  std::string text(std::string_view english) const { return roff_text(said(english)); }
  std::string paragraph(std::string_view english) const { return ".PP\n" + text(english); }

  /// With its full stop.
  std::string sentence(std::string_view english) const {
    return roff_text(said(english) + (chinese_ ? "。" : "."));
  }

  /// In capitals, as headings of manual pages are. What whatis and apropos read, this and the line of the
  /// name, is not escaped: they do not know escapes.
  std::string section(std::string_view name) const {
    return formatted(".SH {}\n", chinese_ ? said(name) : upper(name));
  }

  std::string tagged(const std::string& tag, std::string_view english) const {
    return ".TP\n" + tag + "\n" + text(english);
  }

  std::string parameter_rows(std::span<const Parameter> parameters) const {
    std::string out;
    for (const auto& parameter : parameters) out += tagged(parameter_tag(parameter), parameter.help);
    return out;
  }

  /// `before`: what stands before each line where it is typed.
  std::string example_rows(std::string_view before, std::span<const Example> examples) const {
    std::string out;
    for (const auto& example : examples)
      out += tagged(bold(formatted("{}{}", before, example.line)), example.what);
    return out.empty() ? out : paragraph("Examples:") + out;
  }

  std::string part(const PromptWord& word) const {
    return formatted(".SS {}{}\n", bold(word.name),
                     roff_literal(prompt_usage(word).substr(word.name.size()))) +
           sentence(word.summary) + paragraph(word.details) + example_rows({}, word.examples);
  }

  std::string part(const Command& command) const {
    const auto line = usage_line(command.path);
    auto out = formatted(".SS {}{}\n", bold(command.path), roff_literal(line.substr(command.path.size())));
    out += sentence(command.summary);
    if (!command.details.empty()) out += paragraph(command.details);
    return out + parameter_rows(command.parameters) + example_rows("servoctl ", command.examples);
  }

  std::string entries(std::span<const Entry> all) const {
    std::string out;
    for (const auto& entry : all) out += tagged(bold(entry.name), entry.text);
    return out;
  }

  std::string exit_status() const {
    std::string out;
    for (const auto& row : show::exit_code_topic().rows) {
      auto meaning = row.cells[1].empty() ? std::string() : row.cells[1] + (chinese_ ? "：" : ": ");
      meaning += chinese_ ? row.text_zh + "。" : row.text + ".";
      out += ".TP\n" + bold(row.cells[0]) + "\n" + roff_text(meaning);
    }
    return out +
           paragraph(
               "The words are `error.code` in the document of `--json`. `servoctl explain exit` lists them too.");
  }

  bool chinese_;
};

}  // namespace

std::string man_page(std::string_view version, std::string_view date, bool chinese) {
  const ManPage page(chinese);
  return page.head(version, date) + page.description() + page.options() + page.commands() + page.tables() +
         page.end();
}

}  // namespace servoctl::command
