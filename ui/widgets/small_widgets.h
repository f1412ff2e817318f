#pragma once

#include <vector>

#include <QScrollArea>
#include <QString>
#include <QWidget>

class QAction;
class QGridLayout;
class QHBoxLayout;
class QLabel;
class QScrollArea;
class QToolButton;
class QVBoxLayout;

namespace isoslider::widgets {

/// A thin vertical line between groups of controls.
QWidget* makeSeparator(QWidget* parent);
/// A flat button for an action.
QToolButton* makeToolButton(QAction* action, Qt::ToolButtonStyle style, QWidget* parent);
/// Adds "caption value" to a row and returns the value's label, wide enough not to jump.
QLabel* addReadout(QHBoxLayout* row, const QString& caption, const char* objectName, QWidget* parent);
/// A heading within a panel.
QLabel* makeHeading(const QString& text, QWidget* parent);

/// Rows one above the other on a page that scrolls when it does not fit.
struct ScrollPage {
    QScrollArea* area;
    QWidget* page;
    QVBoxLayout* rows;
};
ScrollPage makeScrollPage(QWidget* parent);
/// The same, as all that the panel shows.
ScrollPage fillWithScrollPage(QWidget* panel);

/// A row of controls that scrolls sideways when there is no room for all of it.
class RowScroll : public QScrollArea {
    Q_OBJECT
public:
    RowScroll(QWidget* row, QWidget* parent);

protected:
    void resizeEvent(QResizeEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void fitHeight();
};

struct Fact {
    QString name;
    QString value;
    QString tip;
};

/// Names and values in two columns; values can be selected and copied.
class FactForm : public QWidget {
    Q_OBJECT
public:
    explicit FactForm(QWidget* parent = nullptr);
    void setFacts(const std::vector<Fact>& facts);
    /// So that the values of forms one above the other begin at one place: at least the width of `name`.
    void reserveNameWidth(const QString& name);

private:
    QGridLayout* grid_;
    std::vector<QLabel*> names_;
    std::vector<QLabel*> values_;
    int nameWidth_ = 0;
};

} // namespace isoslider::widgets
