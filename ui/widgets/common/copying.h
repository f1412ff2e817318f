#pragma once

class QTableView;

namespace isoslider::widgets {

/// Adds "Copy Row" (Ctrl+C while the table has the focus) and "Copy All Rows" to the table's context menu, which shows
/// its actions: headings and rows as the view shows them, separated by tabs and line ends, as spreadsheets take them.
void offerCopying(QTableView& view);

} // namespace isoslider::widgets
