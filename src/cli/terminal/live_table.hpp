#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "show/live_view.hpp"

namespace servoctl::cli {

/// `▁▃█▃`: one character a value, between the least and the largest of the last `width` of them.
std::string sparkline(const std::deque<double>& values, std::size_t width);

/// The rows of a LiveView, and how they are laid out on a screen of any size; no terminal is in it.
class LiveTable {
 public:
  /// So many numbers of a row are kept for its plot.
  static constexpr std::size_t kMostPlotted = 60;

  explicit LiveTable(show::LiveView::Layout layout) : layout_(std::move(layout)) {}

  /// As those of LiveView; shown from the next update() on.
  void set(std::string_view row, std::vector<std::string> cells, std::optional<double> number);
  void remark(std::string text) { remark_ = std::move(text); }

  /// Headings, remarks and cells in Chinese, but for those under `node` and `name`.
  void set_chinese(bool chinese) { chinese_ = chinese; }
  /// All of it in ASCII, as ascii_form() says it.
  void set_ascii(bool ascii) { ascii_ = ascii; }

  /// Paused, or no longer.
  void pause() { paused_ = !paused_; }
  /// By the first column, then by each of the others, then as the rows came.
  void sort_by_next();
  /// Down by so many rows.
  void scroll(int rows);

  /// Takes what the rows say now, and adds their numbers to the plots; not while it is paused.
  void update();
  /// The lines for a screen, none wider than `width`, at most `height` of them; the last one tells the keys.
  std::vector<std::string> lines(std::size_t width, std::size_t height);

 private:
  struct Row {
    std::vector<std::string> cells = {};
    std::optional<double> number = {};  ///< Not in the plot yet.
    std::deque<double> plotted = {};
  };

  void measure();
  std::vector<const Row*> in_order() const;
  /// Widths of the columns, and at last that of the plots (0: none), which fit into `width`.
  std::vector<std::size_t> fitted(std::size_t width) const;
  std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) const;
  std::string shown(std::string_view text);
  std::string in_charset(std::string_view text) const;
  std::string cut(std::string_view text, std::size_t width) const;
  std::string cell(const Row& row, std::size_t column);
  std::string footer(std::size_t first, std::size_t shown) const;

  show::LiveView::Layout layout_;
  std::vector<Row> rows_;
  std::map<std::string, std::size_t, std::less<>> places_;
  std::vector<Row> shown_;           ///< The rows as they were at the last update().
  std::vector<std::size_t> widest_;  ///< Columns do not become narrower: the eye rests on them.
  std::optional<std::size_t> sorted_by_;
  std::string remark_;
  std::size_t first_ = 0;  ///< Row at the top.
  bool paused_ = false;
  bool chinese_ = false;
  bool ascii_ = false;
  std::map<std::string, std::string, std::less<>> known_;  ///< In Chinese: the same is drawn again and again.
};

}  // namespace servoctl::cli
