#pragma once

#include <QString>

namespace isoslider::widgets {

/// Filters of the open dialog: all that can be opened, then by format.
QString volumeFilters();
/// The same, and sessions among all.
QString volumeAndSessionFilters();
/// Filters for files whose samples have no header.
QString rawFilters();
/// Filter of session files.
QString sessionFilters();
/// Filters of the export dialog, one per mesh format.
QString meshFilters();

} // namespace isoslider::widgets
