#pragma once

#include "ui/widgets/viewport/viewport_overlay.h"

namespace isoslider::widgets {

/// One sentence on the view, wrapped where the view is narrow, absent where it is too small for it.
class ViewNote : public ViewReadout {
    Q_OBJECT
public:
    enum class Place { LowerEdge, Centre };
    /// Lies on `view`.
    ViewNote(QWidget& view, Place place);
    /// Empty: nothing is said.
    void say(const QString& text);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void settle();

    QWidget& view_;
    Place place_;
};

} // namespace isoslider::widgets
