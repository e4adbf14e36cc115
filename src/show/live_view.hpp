#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/time.hpp"
#include "report/value.hpp"
#include "show/axis_names.hpp"

namespace servoctl::show {

/// A table that stands on a terminal and is updated where it stands, with a small plot of each row's number.
/// Its keys: space pauses, s sorts by the next column, up and down scroll, q quits.
class LiveView {
 public:
  struct Column {
    std::string title;
    bool right = false;  ///< Numbers stand to the right.
  };
  struct Layout {
    std::vector<Column> columns;
    bool plots = true;              ///< A column with the course of each row's number.
    bool alternate_screen = false;  ///< What stood on the terminal comes back afterwards, and the table goes.
  };

  LiveView() = default;
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;
  virtual ~LiveView() = default;

  /// What nodes are called: in columns with the title `node`, and in remarks.
  void set_names(AxisNames names) { names_ = std::move(names); }

  /// What the row says now, a cell for each column; the first time the row is put under those that are there.
  /// `number`: what is plotted of it.
  virtual void set(std::string_view row, std::vector<std::string> cells,
                   std::optional<double> number = std::nullopt) = 0;
  /// A line that stands under the table until the next one.
  virtual void remark(std::string text) = 0;
  /// Serves the keys, and draws when the last time is 100 ms ago. `now` is any clock that goes on.
  virtual void refresh(TimePoint now) = 0;
  /// q was pressed, or the terminal is gone.
  virtual bool is_over() const = 0;

 protected:
  const AxisNames& names() const { return names_; }

 private:
  AxisNames names_;
};

/// The number to plot of a value; none where it is no number.
std::optional<double> plotted(const report::Value& value);

}  // namespace servoctl::show
