#pragma once

#include <vector>

#include <QFrame>

#include "ui/model/session/recent_file.h"
#include "ui/widgets/common/small_widgets.h"

class QLabel;
class QVBoxLayout;

namespace isoslider::widgets {

class ActionRegistry;

/// What an empty view shows: how to begin.
class StartPage : public QFrame {
    Q_OBJECT
public:
    explicit StartPage(const ActionRegistry& actions, QWidget* parent = nullptr);
    void setRecentFiles(const std::vector<model::RecentFile>& files);
    QSize sizeHint() const override;

Q_SIGNALS:
    void openRequested(const isoslider::model::RecentFile& file);

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    ScrollPage scroll_; ///< for views smaller than the page
    QVBoxLayout* recentLayout_;
    QLabel* recentHeading_;
};

} // namespace isoslider::widgets
