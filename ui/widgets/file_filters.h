#pragma once

#include <QString>

namespace isoslider::widgets {

/// Filters of the open dialog: all that can be opened, then by format.
QString volumeFilters();
/// Filters of the export dialog, one per mesh format.
QString meshFilters();

} // namespace isoslider::widgets
