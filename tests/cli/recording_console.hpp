#pragma once

#include <string>
#include <vector>

#include "cli/terminal/console.hpp"

namespace servoctl::cli {

/// A console that keeps what it is given. Answers no question unless told to.
class RecordingConsole final : public Console {
 public:
  void show_progress(std::string_view line) override { progress.emplace_back(line); }
  bool ask(std::string_view question) override {
    questions.emplace_back(question);
    return answer && questions.size() < refuses_from;
  }
  void pause(std::string_view text) override { pauses.emplace_back(text); }
  bool can_ask() const override { return person; }
  std::size_t width() const override { return columns; }

  std::string out_text;
  std::string err_text;
  std::vector<std::string> questions;
  std::vector<std::string> pauses;
  std::vector<std::string> progress;
  bool answer = false;
  std::size_t refuses_from =
      1'000'000;  ///< The question, counted from 1, from which on `answer` holds no more.
  bool person = false;
  std::size_t columns = 0;

 protected:
  void write_out(std::string_view text) override { out_text += text; }
  void write_err(std::string_view text) override { err_text += text; }
};

}  // namespace servoctl::cli
