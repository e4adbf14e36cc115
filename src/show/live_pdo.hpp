#pragma once

#include "show/live_view.hpp"
#include "show/pdo_book.hpp"

namespace servoctl::show {

/// A row for each object of a PDO: node, PDO, object, value.
LiveView::Layout pdo_layout();

/// Puts what a frame of the PDO brings into a view of this layout; one row with the raw bytes where
/// append_values() shows them.
void show_values(LiveView& live, const PdoView& view, ByteSpan data, bool chinese);

}  // namespace servoctl::show
