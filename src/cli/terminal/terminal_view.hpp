#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/terminal/live_table.hpp"
#include "command/keys.hpp"

namespace servoctl::cli {

/// A screen in text: what is written to it, and how large it is now.
struct Screen {
  struct Size {
    std::size_t columns = 0;
    std::size_t rows = 0;
    bool operator==(const Size&) const = default;
  };
  std::function<void(std::string_view)> write;  ///< With escape sequences.
  std::function<Size()> size;
  std::function<void()> closed = {};  ///< Told when the view is over.
};

/// A LiveView on a terminal.
class TerminalView final : public show::LiveView {
 public:
  TerminalView(Layout layout, Screen screen, std::unique_ptr<command::Keys> keys);
  ~TerminalView() override;

  void set(std::string_view row, std::vector<std::string> cells, std::optional<double> number) override;
  void remark(std::string text) override;
  void refresh(TimePoint now) override;
  bool is_over() const override { return over_; }

  /// As LiveTable::set_chinese().
  void set_chinese(bool chinese) { table_.set_chinese(chinese); }
  /// As LiveTable::set_ascii().
  void set_ascii(bool ascii) { table_.set_ascii(ascii); }
  /// Makes room for other text, which stands above the table from then on.
  void step_aside();

 private:
  /// A node-ID, or what the node is called.
  std::string name_of(std::string node) const;
  int page() const;
  void take_keys();
  void draw();
  /// The cursor at the beginning of the table, whatever has become of the screen since it was drawn.
  std::string to_top(Screen::Size size) const;

  LiveTable table_;
  std::vector<std::string> titles_;
  bool alternate_;
  Screen screen_;
  std::unique_ptr<command::Keys> keys_;
  std::optional<TimePoint> drawn_;
  std::optional<Screen::Size> size_;  ///< When it was drawn.
  std::size_t height_ = 0;            ///< Lines of the table on the screen.
  bool over_ = false;
  unsigned resumed_;
  std::string_view words_before_;  ///< What is said at the end, outside of it.
  std::string last_words_;         ///< The same with what leaves the screen.
};

}  // namespace servoctl::cli
