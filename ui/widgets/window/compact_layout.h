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
/// while the window is small is left alone. Panels that a small window squeezes get the extent back that they had, or
/// were given since, as soon as there is room for it: those beside the view their width, the isovalue's its height.
class CompactLayout : public QObject {
    Q_OBJECT
public:
    CompactLayout(QMainWindow& window, std::vector<QDockWidget*> sidePanels, QDockWidget& isovaluePanel,
                  QWidget& histogram);
    /// The panels are where a saved layout has put them: what was hidden before does not matter any more.
    void restart();
    /// Gives panels beside the view these widths, and the isovalue's this height, now or when there is room.
    void setExtents(const std::map<QDockWidget*, int>& extents);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fit();
    void hidePanels();
    void showPanels();
    bool isBesideView(QDockWidget& panel) const;
    bool isBelowOrAboveView(QDockWidget& panel) const;
    bool isDragging() const;
    std::map<QDockWidget*, int> presentExtents() const;
    void noteExtents();
    void restoreExtents();

    QMainWindow& window_;
    std::vector<QDockWidget*> sidePanels_;
    QDockWidget& isovaluePanel_;
    QWidget& histogram_;
    std::vector<QPointer<QDockWidget>> hidden_;
    std::vector<QPointer<QDockWidget>> wereOnTop_; ///< of those hidden, the ones whose tab was current
    std::map<QDockWidget*, int> extents_; ///< as setExtents() has them, where there is room for them
    std::map<QDockWidget*, int> pressedExtents_; ///< when a mouse button was pressed
    bool isPressed_ = false; ///< a mouse button, on the window itself: a line between panels, it may be
    bool isCompact_ = false;
    QTimer settled_; ///< runs out when nothing has changed its size for a moment
};

} // namespace isoslider::widgets
