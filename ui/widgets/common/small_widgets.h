#pragma once

#include <array>
#include <vector>

#include <QLabel>
#include <QScrollArea>
#include <QString>
#include <QWidget>

class QAction;
class QDialog;
class QGridLayout;
class QHBoxLayout;
class QPushButton;
class QScrollArea;
class QSlider;
class QTableView;
class QToolButton;
class QVBoxLayout;

namespace isoslider::widgets {

/// A thin vertical line between groups of controls.
QWidget* makeSeparator(QWidget* parent);
/// A flat button for an action.
QToolButton* makeToolButton(QAction* action, Qt::ToolButtonStyle style, QWidget* parent);
/// Adds "caption value" to a row and returns the value's label, wide enough not to jump.
QLabel* addReadout(QHBoxLayout* row, const QString& caption, const char* objectName, QWidget* parent);
/// A new value for it, for the eye and for assistive technology.
void setReadout(QLabel* readout, const QString& text);
/// A caption, a slider that takes the room there is, and a text for its value: as wide as `widest`.
struct SliderRow {
    QHBoxLayout* row;
    QSlider* slider;
    QLabel* value;
};
SliderRow makeSliderRow(const QString& caption, const QString& widest, QWidget* parent);
/// A heading within a panel.
QLabel* makeHeading(const QString& text, QWidget* parent);

/// What tables in panels have in common: rows without frame, grid or numbers, each second one darker.
void makePlain(QTableView& table);

/// A tip that is shown letter by letter: one that a file has a word in must not be taken for HTML.
QString plainTip(const QString& text);

/// Rows one above the other on a page that scrolls when it does not fit.
struct ScrollPage {
    QScrollArea* area;
    QWidget* page;
    QVBoxLayout* rows;
};
ScrollPage makeScrollPage(QWidget* parent);
/// The same, as all that the panel shows.
ScrollPage fillWithScrollPage(QWidget* panel);

/// Boxes for x, y and z side by side. They get the object name with that letter behind it, and accessible names
/// such as "Spacing along X".
QWidget* makeAxisRow(const std::array<QWidget*, 3>& boxes, const char* objectName, const QString& name,
                     QWidget* parent);

/// How dialogs that show a file before it is opened are laid out.
struct FileDialogFrame {
    QVBoxLayout* top; ///< the file's name; more may follow
    QHBoxLayout* bottom; ///< the buttons; more may come before them
    QPushButton* open; ///< the default; accepts nothing by itself
};
/// Lays out a dialog: the file's name, `left` and `right` side by side, buttons to open and to cancel.
FileDialogFrame layOutFileDialog(QDialog* dialog, const QString& fileName, QWidget* left, QWidget* right);

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

/// A line of text with dots where there is no room for all of it, which the tool tip then shows: at its end, or in the
/// middle, as suits names of files.
class ElidedLabel : public QLabel {
    Q_OBJECT
public:
    explicit ElidedLabel(QWidget* parent = nullptr, Qt::TextElideMode mode = Qt::ElideRight);
    void setFullText(const QString& text);
    const QString& fullText() const { return fullText_; }
    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    void elide();

    QString fullText_;
    Qt::TextElideMode mode_;
};

struct Fact {
    QString name;
    QString value;
    QString tip;
};

/// Names and values in two columns; values can be selected and copied, one or all by the context menu.
class FactForm : public QWidget {
    Q_OBJECT
public:
    explicit FactForm(QWidget* parent = nullptr);
    void setFacts(const std::vector<Fact>& facts);
    /// So that the values of forms one above the other begin at one place: at least the width of `name`.
    void reserveNameWidth(const QString& name);

protected:
    void contextMenuEvent(QContextMenuEvent* event) override;

private:
    QString text() const;

    QGridLayout* grid_;
    std::vector<QLabel*> names_;
    std::vector<QLabel*> values_;
    int nameWidth_ = 0;
};

} // namespace isoslider::widgets
