#include "ui/widgets/window/help_dialogs.h"

#include <array>

#include <QAction>
#include <QApplication>
#include <QDialog>
#include <QDialogButtonBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QIcon>
#include <QLabel>
#include <QScrollArea>
#include <QVBoxLayout>

#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kKeysWidth = 186;

struct Gesture {
    QString keys;
    QString effect;
};

QString tr(const char* text) { return QCoreApplication::translate("HelpDialogs", text); }

std::vector<Gesture> viewGestures() {
    return {{tr("Left drag"), tr("Turn about the volume's centre")},
            {tr("Middle drag, Shift+left drag"), tr("Move the view")},
            {tr("Wheel, right drag"), tr("Zoom to the pointer")},
            {tr("Ctrl+arrow keys"), tr("Turn; the view must have been clicked")},
            {tr("Shift+arrow keys"), tr("Move the view")},
            {tr("Ctrl+Page Up, Page Down"), tr("Zoom")},
            {tr("Ctrl+wheel"), tr("Step the isovalue; with Shift 10 times finer")},
            {tr("Click"), tr("Move the crosshair to the surface or slice there")},
            {tr("Alt+wheel"), tr("Push the slice away, or pull it closer")},
            {tr("Drag a point of the crop box"), tr("Move that face; of the clip plane, move or turn it")},
            {tr("Click on the cube"), tr("Show its side straight on")}};
}

std::vector<Gesture> sliceGestures() {
    return {{tr("Click, left drag"), tr("Move the crosshair")},
            {tr("Wheel, Page Up, Page Down"), tr("Go through the slices; page keys with Shift by ten")},
            {tr("Home, End"), tr("First and last slice")},
            {tr("Arrow keys"), tr("Move the crosshair by a sample")},
            {tr("Right drag"), tr("Window: sideways its width, up and down its level")},
            {tr("Double click"), tr("Automatic window")},
            {tr("Shift+wheel, + and −"), tr("Zoom; 0 shows all of the slice")},
            {tr("Middle drag, Shift+left drag"), tr("Move the picture")},
            {tr("Ctrl+wheel"), tr("Step the isovalue")},
            {tr("Right click"), tr("Isovalue of the place, window, layout")}};
}

std::vector<Gesture> isovalueGestures() {
    return {{tr("Drag on the histogram"), tr("Move the isovalue; with Shift 10 times finer")},
            {tr("Click on a mark"), tr("Move just past an event of the topology")},
            {tr("Wheel, arrow keys"),
             tr("Step: whole numbers by 1, others by 0.1 % of the view; with Shift 10 times finer")},
            {tr("Page Up, Page Down"), tr("10 steps; with Ctrl 100; with Shift 10 times finer")},
            {tr("Home, End"), tr("Smallest and largest value")},
            {tr("Ctrl+wheel, wheel on the axis, + and −"), tr("Zoom the histogram")},
            {tr("Ctrl+drag"), tr("Zoom to what the drag covers")},
            {tr("Drag the axis, middle drag"), tr("Move the histogram's range")},
            {tr("Double click"), tr("Show the usual range; again, the whole one")},
            {tr("Right click"), tr("Axes, snapping and zoom")}};
}

std::vector<Gesture> shortcutsOf(const ActionRegistry::Section& section) {
    std::vector<Gesture> gestures;
    for (const QAction* action : section.actions) {
        if (action->shortcuts().isEmpty())
            continue;
        const QString keys = QKeySequence::listToString(action->shortcuts(), QKeySequence::NativeText);
        gestures.push_back({QString(keys).replace(QStringLiteral(";"), QStringLiteral(" ")), action->statusTip()});
    }
    return gestures;
}

void addTable(QVBoxLayout* column, const QString& title, const std::vector<Gesture>& gestures, QWidget* parent) {
    column->addWidget(makeHeading(title, parent));
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(18);
    grid->setVerticalSpacing(3);
    grid->setColumnStretch(1, 1);
    int row = 0;
    for (const auto& gesture : gestures) {
        auto* keys = new QLabel(gesture.keys, parent);
        keys->setFixedWidth(kKeysWidth);
        keys->setWordWrap(true);
        grid->addWidget(keys, row, 0, Qt::AlignTop);
        auto* effect = new QLabel(gesture.effect, parent);
        makeQuiet(effect);
        effect->setWordWrap(true); // or the longest line makes the sheet wider than its window
        grid->addWidget(effect, row++, 1, Qt::AlignTop);
    }
    column->addLayout(grid);
    column->addSpacing(10);
}

QDialog* makeDialog(const QString& title, const char* name, QWidget* parent) {
    auto* dialog = new QDialog(parent);
    dialog->setObjectName(QLatin1String(name));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(title);
    return dialog;
}

QDialogButtonBox* makeCloseButton(QDialog* dialog) {
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, dialog);
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::close);
    return buttons;
}

} // namespace

void showShortcutSheet(const ActionRegistry& actions, QWidget* parent) {
    auto* dialog = makeDialog(tr("Keyboard Shortcuts"), "shortcutSheet", parent);
    auto* layout = new QVBoxLayout(dialog);
    auto* scroll = new QScrollArea(dialog);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    auto* page = new QWidget(scroll);
    auto* columns = new QHBoxLayout(page);
    columns->setSpacing(36);
    std::array<QVBoxLayout*, 2> column{};
    for (auto*& each : column) {
        columns->addLayout(each = new QVBoxLayout, 1);
        each->setSpacing(6); // otherwise that of the columns
    }
    addTable(column[0], tr("Mouse in the view"), viewGestures(), page);
    addTable(column[0], tr("Mouse and keys on a slice"), sliceGestures(), page);
    addTable(column[0], tr("Histogram"), isovalueGestures(), page);
    const auto& sections = actions.sections();
    for (std::size_t i = 0; i < sections.size(); ++i)
        addTable(column[i == 3 ? 1 : i == 0 || i == 4 ? 0 : 1], sections[i].title, shortcutsOf(sections[i]), page);
    for (auto* each : column)
        each->addStretch(1);
    scroll->setWidget(page);
    layout->addWidget(scroll);
    layout->addWidget(makeCloseButton(dialog));
    dialog->resize(1180, 620);
    dialog->show();
}

void showAbout(QWidget* parent) {
    auto* dialog = makeDialog(tr("About ISOSLIDER"), "aboutDialog", parent);
    auto* layout = new QVBoxLayout(dialog);
    layout->setContentsMargins(28, 22, 28, 18);
    layout->setSpacing(8);
    auto* logo = new QLabel(dialog);
    logo->setPixmap(
        QIcon(QStringLiteral(":/isoslider/icons/isoslider.svg")).pixmap(QSize(72, 72), dialog->devicePixelRatioF()));
    auto* text = new QLabel(
        tr("<h3>ISOSLIDER %1</h3>"
           "<p>Slides isosurfaces through large volumes: an index of edge changes, built once,<br>"
           "lets the isovalue move while only what changes is updated.</p>"
           "<p>After Chhugani, Vishwanath, Cohen, Kumar: <i>ISOSLIDER: A System for<br>"
           "Interactive Exploration of Isosurfaces</i>, 2003.</p>"
           "<p>Free software under the GNU General Public License, version 3 or later.<br>"
           "Built with Qt, OpenMesh, QCustomPlot, VTK, GDCM, libtiff, HDF5, NetCDF, oneTBB, GLM, zstd and xxHash.</p>")
            .arg(QApplication::applicationVersion().toHtmlEscaped()),
        dialog);
    text->setTextInteractionFlags(Qt::TextBrowserInteraction);
    layout->addWidget(logo);
    layout->addWidget(text);
    layout->addWidget(makeCloseButton(dialog));
    dialog->show();
}

} // namespace isoslider::widgets
