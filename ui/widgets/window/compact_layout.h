#pragma once

#include <map>
#include <vector>

#include <QObject>
#include <QPointer>
#include <QTimer>

class QDockWidget;
class QMainWindow;

namespace isoslider::widgets {

/// In a window too small for all of its panels, leaves the view and the isovalue: hides the panels beside them, lets
/// the histogram become low, and brings all back when there is room or the window is closed. A panel that is shown
/// while the window is small is left alone. Panels that a narrow window squeezes get the width back that they had, or
/// were given since, as soon as there is room for it.
class CompactLayout : public QObject {
    Q_OBJECT
public:
    CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QWidget& histogram);
    /// The panels are where a saved layout has put them: what was hidden before does not matter any more.
    void restart();
    /// Gives panels beside the view these widths, now or when there is room.
    void setWidths(const std::map<QDockWidget*, int>& widths);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fit();
    void hidePanels();
    void showPanels();
    bool isBesideView(QDockWidget& panel) const;
    static bool isDragging();
    std::map<QDockWidget*, int> presentWidths() const;
    void noteWidths();
    void restoreWidths();

    QMainWindow& window_;
    std::vector<QDockWidget*> sidePanels_;
    QWidget& histogram_;
    std::vector<QPointer<QDockWidget>> hidden_;
    std::vector<QPointer<QDockWidget>> wereOnTop_; ///< of those hidden, the ones whose tab was current
    std::map<QDockWidget*, int> widths_; ///< of the panels beside the view, where there is room for them
    std::map<QDockWidget*, int> pressedWidths_; ///< when a mouse button was pressed
    bool isCompact_ = false;
    QTimer settled_; ///< runs out when nothing has changed its size for a moment
};

} // namespace isoslider::widgets
