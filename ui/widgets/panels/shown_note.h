#pragma once

#include <QString>

namespace isoslider::model {
class Session;
struct ViewOptions;
} // namespace isoslider::model

namespace isoslider::widgets {

/// What of the active surface, all of which is counted, is shown; empty: all of it. O(pieces).
QString shownNote(const model::Session& session, const model::ViewOptions& options);

} // namespace isoslider::widgets
