#pragma once

#include <QWidget>

#include "ui/model/surface/scale_bar.h"

namespace isoslider::widgets {

/// A bar with its length over it, legible on any picture; lets all pointer events through.
class ScaleBarView : public QWidget {
    Q_OBJECT
public:
    /// Most pixels of a bar: what fits beside a note in the middle of the view.
    static constexpr double kMostPixels = 92.0;

    explicit ScaleBarView(QWidget* parent);

    /// Takes the size that it needs. `text`: the length with its unit.
    void setBar(const model::ScaleBar& bar, const QString& text);
    const model::ScaleBar& bar() const { return bar_; }
    const QString& text() const { return text_; }
    void paint(QPainter& painter) const;
    QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;
    void changeEvent(QEvent* event) override;

private:
    model::ScaleBar bar_;
    QString text_;
};

} // namespace isoslider::widgets
