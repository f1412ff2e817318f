#pragma once

#include <vector>

#include <QObject>
#include <QPointer>

class QDockWidget;
class QMainWindow;

namespace isoslider::widgets {

/// In a window too small for all of its panels, leaves the view and the isovalue: hides the panels beside them, lets the
/// histogram become low, and brings all back when there is room or the window is closed. A panel that is shown while
/// the window is small is left alone.
class CompactLayout : public QObject {
    Q_OBJECT
public:
    CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QWidget& histogram);
    /// The panels are where a saved layout has put them: what was hidden before does not matter any more.
    void startAnew();

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fit();
    void hidePanels();
    void showPanels();

    QMainWindow& window_;
    std::vector<QDockWidget*> sidePanels_;
    QWidget& histogram_;
    std::vector<QPointer<QDockWidget>> hidden_;
    std::vector<QPointer<QDockWidget>> wereOnTop_; ///< of those hidden, the ones whose tab was current
    bool isCompact_ = false;
};

} // namespace isoslider::widgets
