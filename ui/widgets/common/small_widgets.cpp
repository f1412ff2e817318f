#include "ui/widgets/common/small_widgets.h"

#include <QAction>
#include <QClipboard>
#include <QContextMenuEvent>
#include <QDialog>
#include <QDialogButtonBox>
#include <QEvent>
#include <QFrame>
#include <QGridLayout>
#include <QGuiApplication>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QTableView>
#include <QTextDocument>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/widgets/common/focus_frame.h"
#include "ui/widgets/common/text_colour.h"

namespace isoslider::widgets {
namespace {

constexpr const char* kCaptionProperty = "caption";

} // namespace

QWidget* makeSeparator(QWidget* parent) {
    auto* line = new QFrame(parent);
    line->setFrameShape(QFrame::VLine);
    line->setFrameShadow(QFrame::Plain);
    QPalette palette = line->palette();
    QColor colour = palette.color(QPalette::WindowText);
    colour.setAlpha(60);
    palette.setColor(QPalette::WindowText, colour);
    line->setPalette(palette);
    line->setFixedHeight(20);
    return line;
}

QToolButton* makeToolButton(QAction* action, Qt::ToolButtonStyle style, QWidget* parent) {
    auto* button = new QToolButton(parent);
    button->setDefaultAction(action);
    button->setToolButtonStyle(style);
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::TabFocus);
    button->setIconSize(QSize(18, 18));
    return button;
}

QLabel* addReadout(QHBoxLayout* row, const QString& caption, const char* objectName, QWidget* parent) {
    auto* name = new QLabel(caption, parent);
    makeQuiet(name);
    auto* value = new QLabel(parent);
    value->setObjectName(QLatin1String(objectName));
    value->setProperty(kCaptionProperty, caption);
    setReadout(value, QStringLiteral("–"));
    value->setMinimumWidth(value->fontMetrics().horizontalAdvance(QStringLiteral("-0000.000")));
    value->setTextInteractionFlags(Qt::TextSelectableByMouse);
    row->addSpacing(6);
    row->addWidget(name);
    row->addWidget(value);
    return value;
}

// A name stands in for a label's text, so it has to hold both.
void setReadout(QLabel* readout, const QString& text) {
    readout->setText(text);
    readout->setAccessibleName(FactForm::tr("%1: %2").arg(readout->property(kCaptionProperty).toString(), text));
}

SliderRow makeSliderRow(const QString& caption, const QString& widest, QWidget* parent) {
    SliderRow made{new QHBoxLayout, new QSlider(Qt::Horizontal, parent), new QLabel(parent)};
    auto* name = new QLabel(caption, parent);
    name->setBuddy(made.slider);
    made.slider->setMinimumWidth(40);
    made.value->setMinimumWidth(parent->fontMetrics().horizontalAdvance(widest));
    made.value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    made.row->addWidget(name);
    made.row->addWidget(made.slider, 1);
    made.row->addWidget(made.value);
    return made;
}

QLabel* makeHeading(const QString& text, QWidget* parent) {
    auto* label = new QLabel(text, parent);
    QFont font = label->font();
    font.setBold(true);
    label->setFont(font);
    return label;
}

void makePlain(QTableView& table) {
    table.setFrameShape(QFrame::NoFrame);
    table.setShowGrid(false);
    table.setAlternatingRowColors(true);
    table.setWordWrap(false);
    table.setTabKeyNavigation(false);
    table.verticalHeader()->hide();
    table.horizontalHeader()->setHighlightSections(false);
}

QString plainTip(const QString& text) {
    return Qt::mightBeRichText(text)
               ? QStringLiteral("<p style=\"white-space:pre-wrap\">%1</p>").arg(text.toHtmlEscaped())
               : text;
}

ScrollPage makeScrollPage(QWidget* parent) {
    ScrollPage made{};
    made.area = new QScrollArea(parent);
    made.area->setWidgetResizable(true);
    made.area->setFrameShape(QFrame::NoFrame);
    made.area->setMinimumSize(80, 20); // in a small window the view comes first
    made.page = new QWidget(made.area);
    made.rows = new QVBoxLayout(made.page);
    made.rows->setContentsMargins(10, 8, 10, 8);
    made.area->setWidget(made.page); // which must have its layout by now
    new FocusFrame(*made.area);
    return made;
}

ScrollPage fillWithScrollPage(QWidget* panel) {
    auto* outer = new QVBoxLayout(panel);
    outer->setContentsMargins(0, 0, 0, 0);
    const ScrollPage made = makeScrollPage(panel);
    outer->addWidget(made.area);
    return made;
}

QWidget* makeAxisRow(const std::array<QWidget*, 3>& boxes, const char* objectName, const QString& name,
                     QWidget* parent) {
    auto* row = new QWidget(parent);
    auto* layout = new QHBoxLayout(row);
    layout->setContentsMargins(0, 0, 0, 0);
    for (std::size_t axis = 0; axis < boxes.size(); ++axis) {
        const QChar letter = QLatin1Char("XYZ"[axis]);
        boxes[axis]->setObjectName(QLatin1String(objectName) + letter);
        boxes[axis]->setAccessibleName(FactForm::tr("%1 along %2").arg(name, letter));
        layout->addWidget(boxes[axis], 1);
    }
    return row;
}

FileDialogFrame layOutFileDialog(QDialog* dialog, const QString& fileName, QWidget* left, QWidget* right) {
    auto* layout = new QVBoxLayout(dialog);
    layout->setContentsMargins(16, 14, 16, 14);
    layout->setSpacing(10);
    FileDialogFrame frame{new QVBoxLayout, new QHBoxLayout, nullptr};
    frame.top->setSpacing(10);
    auto* heading = new ElidedLabel(dialog, Qt::ElideMiddle);
    heading->setObjectName(QStringLiteral("fileName"));
    QFont bold = heading->font();
    bold.setBold(true);
    heading->setFont(bold);
    heading->setFullText(fileName);
    heading->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred); // a long name makes no wide dialog
    frame.top->addWidget(heading);
    layout->addLayout(frame.top);
    auto* columns = new QHBoxLayout;
    columns->setSpacing(16);
    columns->addWidget(left);
    columns->addWidget(right, 1);
    layout->addLayout(columns, 1);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel, dialog);
    frame.open = buttons->button(QDialogButtonBox::Open);
    frame.open->setDefault(true);
    frame.bottom->addWidget(buttons, 1);
    layout->addLayout(frame.bottom);
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    return frame;
}

RowScroll::RowScroll(QWidget* row, QWidget* parent) : QScrollArea(parent) {
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFocusPolicy(Qt::NoFocus);
    setMinimumWidth(0);
    setWidget(row);
    row->installEventFilter(this);
    fitHeight();
}

void RowScroll::fitHeight() {
    const bool needsBar = width() < widget()->minimumSizeHint().width();
    setFixedHeight(widget()->sizeHint().height() + (needsBar ? horizontalScrollBar()->sizeHint().height() : 0));
}

void RowScroll::resizeEvent(QResizeEvent* event) {
    QScrollArea::resizeEvent(event);
    fitHeight();
}

bool RowScroll::eventFilter(QObject* watched, QEvent* event) {
    if (watched == widget() && event->type() == QEvent::LayoutRequest)
        fitHeight(); // its texts grew or shrank
    return QScrollArea::eventFilter(watched, event);
}

ElidedLabel::ElidedLabel(QWidget* parent, Qt::TextElideMode mode) : QLabel(parent), mode_(mode) {
    setTextFormat(Qt::PlainText);
}

void ElidedLabel::setFullText(const QString& text) {
    if (text == fullText_)
        return;
    fullText_ = text;
    setAccessibleName(text);
    updateGeometry();
    elide();
}

QSize ElidedLabel::sizeHint() const {
    return {fontMetrics().horizontalAdvance(fullText_) + 2 * margin() + 2, QLabel::sizeHint().height()};
}

QSize ElidedLabel::minimumSizeHint() const {
    return {fontMetrics().horizontalAdvance(QLatin1Char('m')), QLabel::minimumSizeHint().height()};
}

void ElidedLabel::resizeEvent(QResizeEvent* event) {
    QLabel::resizeEvent(event);
    elide();
}

void ElidedLabel::elide() {
    const QString shown = fontMetrics().elidedText(fullText_, mode_, std::max(0, width() - 2 * margin()));
    if (shown != text())
        setText(shown);
    setToolTip(shown == fullText_ ? QString() : plainTip(fullText_));
}

// Not a QFormLayout: when rows come and go, it shares the height of wrapped texts out among all rows.
FactForm::FactForm(QWidget* parent) : QWidget(parent), grid_(new QGridLayout(this)) {
    grid_->setContentsMargins(0, 0, 0, 0);
    grid_->setHorizontalSpacing(14);
    grid_->setVerticalSpacing(3);
    grid_->setColumnStretch(1, 1);
}

void FactForm::reserveNameWidth(const QString& name) {
    nameWidth_ = fontMetrics().horizontalAdvance(name) + 1;
    for (QLabel* label : names_)
        label->setMinimumWidth(nameWidth_);
}

// A row for each, name and value separated by a tab, as spreadsheets take them.
QString FactForm::text() const {
    QString all;
    for (std::size_t row = 0; row < names_.size(); ++row)
        if (!names_[row]->isHidden())
            all += names_[row]->text() + QLatin1Char('\t') + values_[row]->text() + QLatin1Char('\n');
    return all;
}

void FactForm::contextMenuEvent(QContextMenuEvent* event) {
    auto* menu = new QMenu(this);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    const auto copy = [](const QString& what) { return [what] { QGuiApplication::clipboard()->setText(what); }; };
    for (std::size_t row = 0; row < values_.size(); ++row) {
        const QLabel& value = *values_[row];
        const int top = value.geometry().top(), bottom = value.geometry().bottom();
        if (value.isHidden() || event->pos().y() < top || event->pos().y() > bottom)
            continue;
        const QString selected = value.selectedText();
        auto* one = menu->addAction(selected.isEmpty() ? tr("Copy &Value") : tr("Copy &Selection"),
                                    copy(selected.isEmpty() ? value.text() : selected));
        one->setObjectName(QStringLiteral("copyFact"));
    }
    menu->addAction(tr("Copy &All"), copy(text()))->setObjectName(QStringLiteral("copyFacts"));
    menu->popup(event->globalPos());
}

void FactForm::setFacts(const std::vector<Fact>& facts) {
    while (names_.size() < facts.size()) {
        auto* name = new QLabel(this);
        makeQuiet(name);
        name->setAlignment(Qt::AlignLeft | Qt::AlignTop); // beside the first line of a value of several
        name->setMinimumWidth(nameWidth_);
        auto* value = new QLabel(this);
        value->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
        value->setContextMenuPolicy(Qt::NoContextMenu); // the form's, which can do more
        value->setWordWrap(true);
        value->setTextFormat(Qt::PlainText);
        value->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
        const int row = static_cast<int>(names_.size());
        grid_->addWidget(name, row, 0, Qt::AlignLeft | Qt::AlignTop);
        grid_->addWidget(value, row, 1);
        names_.push_back(name);
        values_.push_back(value);
    }
    for (std::size_t row = 0; row < names_.size(); ++row) {
        const bool isUsed = row < facts.size();
        if (!isUsed) {
            names_[row]->hide();
            values_[row]->hide();
            continue;
        }
        names_[row]->setText(facts[row].name);
        values_[row]->setText(facts[row].value);
        values_[row]->setToolTip(plainTip(facts[row].tip));
        values_[row]->setAccessibleName(tr("%1: %2").arg(facts[row].name, facts[row].value));
        names_[row]->show(); // lays out all around it: by its text
        values_[row]->show();
    }
    // Now rather than when the event for it comes: the page's may come first, and ask how high this form was.
    grid_->activate();
}

} // namespace isoslider::widgets
