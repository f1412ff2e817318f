#pragma once

#include <QWidget>

namespace isoslider::widgets {

/// Marks the edge of a widget that shows no focus itself, while it has the keyboard by a key and not by a click.
class FocusFrame : public QWidget {
    Q_OBJECT
public:
    /// `marked` owns it.
    explicit FocusFrame(QWidget& marked);

protected:
    void paintEvent(QPaintEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    QWidget& marked_;
};

} // namespace isoslider::widgets
