#pragma once

#include <QString>

class QTableView;

namespace isoslider::widgets {

/// The headings and the rows, or one of them, as the view shows them: columns separated by tabs, rows by line ends, as
/// spreadsheets take them. `row` counts in the view's order; -1: all.
QString tableText(const QTableView& view, int row = -1);

/// Adds "Copy Row" (Ctrl+C while the table has the focus) and "Copy All Rows" to the table's context menu.
void offerCopying(QTableView& view);

} // namespace isoslider::widgets
