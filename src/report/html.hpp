#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "report/value.hpp"

/// Values as a page for a browser and for paper.
namespace servoctl::report {

/// Puts a heading, or a word such as `yes`, into the reader's language.
using Translate = std::function<std::string(std::string_view)>;

/// The value as HTML: records and tables as tables, plots as drawings, each below the heading it has,
/// of this level. Shows what text shows. Nothing in it becomes markup.
std::string to_html(const Value& value, const Translate& translate = {}, int level = 4);

/// A page of its own: no scripts, nothing loaded from anywhere, readable on a telephone and printed on A4.
struct Page {
  bool chinese = false;
  std::string title;
  Translate translate = {};
  struct Section {
    std::string title;
    int level = 2;          ///< 2: of the page; 3: of the section before.
    Value value = {};       ///< May be null: only the heading.
    std::string note = {};  ///< A sentence below the heading.
    /// On paper it begins a new sheet, and all sheets up to the next such section carry its title at their
    /// head.
    bool new_sheet = false;
  };
  std::vector<Section> sections = {};
  std::string picture = {};  ///< Above the title: a data: URI of image/…; empty: none.
  std::string foot = {};     ///< At the foot of each sheet, beside its number, where the browser can.
  /// Lines to be signed at the end, together on one sheet; empty: none.
  std::vector<std::string> signatures = {};
};
std::string html_page(const Page& page);

}  // namespace servoctl::report
