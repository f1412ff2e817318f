#pragma once

#include <QObject>
#include <QRect>
#include <QString>

class QLabel;
class QToolButton;

namespace isoslider::widgets {

class HistogramPlot;

/// What stands over the histogram in words: what the pointer is at, which samples lie out of view, where the handle is
/// if it does, and a note. A click on what is out of view brings it there.
class HistogramHints : public QObject {
    Q_OBJECT
public:
    explicit HistogramHints(HistogramPlot& plot);

    /// After any change of the plot's range, scale, size or values.
    void update();
    void updateHandle();
    void showReadout(double pixel);
    void hideReadout();
    /// A quiet line; empty: none.
    void setNote(const QString& note);
    void applyPalette();

private:
    QLabel* makeLabel(const char* name);
    QToolButton* makeButton(const char* name);
    void place(QToolButton& button, bool isShown, const QString& text, bool isLeft, int y);
    void placeNote();
    QString readoutText(double pixel, bool statesDeviations) const;

    HistogramPlot& plot_;
    QLabel* readout_;
    QLabel* note_;
    QToolButton* lower_; ///< samples below what is in view
    QToolButton* upper_;
    QToolButton* handle_; ///< where it is, if out of view
    QRect placedFor_; ///< the axes' place when these were placed
};

} // namespace isoslider::widgets
