#include "ui/widgets/window/action_registry.h"

#include <QAction>
#include <QCoreApplication>
#include <QKeySequence>
#include <QWidget>

#include "core/base/check.h"
#include "ui/widgets/common/icon_loader.h"

namespace isoslider::widgets {
namespace {

struct ActionSpec {
    const char* id;
    const char* text;
    const char* shortcuts; ///< separated by blanks
    const char* tip;
    const char* icon;
    bool isCheckable = false;
};

struct SectionSpec {
    const char* title;
    std::vector<ActionSpec> actions;
};

#define TR(text) QT_TRANSLATE_NOOP("Actions", text)

const std::vector<SectionSpec>& specs() {
    static const std::vector<SectionSpec> all{
        {TR("File"),
         {{"file.open", TR("&Open Volume…"), "Ctrl+O", TR("Open a volume or an index file"), "open"},
          {"file.openFolder", TR("Open &Folder…"), "Ctrl+Shift+O", TR("Open a folder of slices: DICOM or pictures"),
           "open"},
          {"file.importRaw", TR("&Import Raw Samples…"), "",
           TR("Open a file without a header, saying how its samples are arranged"), ""},
          {"file.previewsFirst", TR("&Preview Before Opening"), "",
           TR("Show a file chosen with Open Volume before it is opened"), "", true},
          {"file.sampleBluntFin", TR("&Blunt Fin"), "", TR("Open the Blunt Fin air-flow sample"), "sample"},
          {"file.sampleShell", TR("&Spherical Shell"), "", TR("Open the spherical shell sample"), "sample"},
          {"file.openSession", TR("Open Sessio&n…"), "", TR("Show a volume again as a session file keeps it"), ""},
          {"file.saveSession", TR("&Save Session…"), "Ctrl+S", TR("Save volume, isovalue and view to a file"), ""},
          {"file.saveImage", TR("Save &View as Image…"), "Ctrl+Shift+S", TR("Save the 3-D view as a PNG image"),
           "image"},
          {"file.close", TR("&Close Volume"), "Ctrl+W", TR("Close the volume and show the start page"), "close"},
          {"file.quit", TR("&Quit"), "Ctrl+Q", TR("Quit ISOSLIDER"), ""}}},
        {TR("Isovalue"),
         {{"isovalue.edit", TR("&Type an Isovalue"), "Ctrl+L", TR("Type an isovalue in data units"), "isovalue"},
          {"isovalue.play", TR("&Play"), "P", TR("Animate the isovalue"), "play", true},
          {"isovalue.logCounts", TR("&Logarithmic Counts"), "L",
           TR("Show the histogram's counts on a logarithmic axis"), "", true},
          {"isovalue.coarserWhileMoving", TR("&Coarser While Moving"), "",
           TR("Fewer triangles while the handle is held, all of them when it rests"), "", true},
          {"isovalue.resetZoom", TR("Whole &Range"), "Ctrl+0", TR("Show the histogram's whole range"), "fit"},
          {"isovalue.previousEvent", TR("Pre&vious Event"), "[", TR("Move to the previous event of the topology"), ""},
          {"isovalue.nextEvent", TR("&Next Event"), "]", TR("Move to the next event of the topology"), ""},
          {"isovalue.snap", TR("&Snap to Events"), "",
           TR("A drag near the mark of an event goes just past it; not while Shift is held"), "", true},
          {"isovalue.clearEvent", TR("&Unmark Event"), "Esc", TR("Take away the mark of the chosen event"), ""}}},
        {TR("Mesh"),
         {{"mesh.check", TR("&Check Mesh"), "Ctrl+K", TR("Check that the surface is manifold, closed and oriented"),
           "check"},
          {"mesh.export", TR("&Export Mesh…"), "Ctrl+E", TR("Write the surface to a mesh file"), "export"},
          {"index.build", TR("&Build Index"), "", TR("Build the index again after a failure or a cancel"), "build"}}},
        {TR("View"),
         {{"view.reset", TR("&Reset View"), "R F", TR("Show the whole volume"), "fit"},
          {"view.front", TR("&Front"), "1", TR("Look along +Y"), ""},
          {"view.back", TR("&Back"), "Ctrl+1", TR("Look along −Y"), ""},
          {"view.right", TR("R&ight"), "3", TR("Look along −X"), ""},
          {"view.left", TR("&Left"), "Ctrl+3", TR("Look along +X"), ""},
          {"view.top", TR("&Top"), "7", TR("Look along −Z"), ""},
          {"view.bottom", TR("B&ottom"), "Ctrl+7", TR("Look along +Z"), ""},
          {"view.perspective", TR("&Perspective"), "5", TR("Perspective or orthographic projection"), "perspective",
           true},
          {"view.changed", TR("Hi&ghlight Changes"), "G", TR("Marks red what the last move retriangulated"),
           "highlight", true},
          {"view.edges", TR("Triangle &Edges"), "W", TR("Show the edges of the surface's triangles"), "edges", true},
          {"view.levels", TR("Cell Si&zes"), "C", TR("Colour merged cells by their size"), "", true},
          {"view.box", TR("&Bounding Box"), "B", TR("Show the volume's bounding box"), "box", true},
          {"view.axes", TR("Orientation &Axes"), "A", TR("Show the directions of X, Y and Z"), "axes", true},
          {"view.readout", TR("Rea&dout"), "T", TR("Show isovalue, triangles and milliseconds in the view"), "readout",
           true},
          {"view.fullScreen", TR("F&ull Screen"), "F11", TR("Fill the screen with the window"), "", true},
          {"view.resetLayout", TR("Reset &Layout"), "", TR("Put all panels back in their places"), ""}}},
        {TR("Help"),
         {{"help.shortcuts", TR("&Keyboard Shortcuts"), "F1 ?", TR("Show what keys and mouse buttons do"), "keyboard"},
          {"help.about", TR("&About ISOSLIDER"), "", TR("Version and licence"), "info"}}}};
    return all;
}

#undef TR

QString translated(const char* text) { return QCoreApplication::translate("Actions", text); }

QList<QKeySequence> keySequences(const char* shortcuts) {
    QList<QKeySequence> sequences;
    for (const auto& part : QString::fromLatin1(shortcuts).split(QLatin1Char(' '), Qt::SkipEmptyParts))
        sequences << QKeySequence(part);
    return sequences;
}

QString tipWithShortcut(const ActionSpec& spec, const QList<QKeySequence>& keys) {
    if (keys.isEmpty())
        return translated(spec.tip);
    return QStringLiteral("%1 (%2)").arg(translated(spec.tip), keys.first().toString(QKeySequence::NativeText));
}

} // namespace

ActionRegistry::ActionRegistry(QWidget* window) : QObject(window), window_(window) {
    for (const auto& sectionSpec : specs()) {
        Section section{translated(sectionSpec.title), {}};
        for (const auto& spec : sectionSpec.actions) {
            auto* action = new QAction(translated(spec.text), this);
            const auto keys = keySequences(spec.shortcuts);
            action->setObjectName(QLatin1String(spec.id));
            action->setShortcuts(keys);
            action->setToolTip(tipWithShortcut(spec, keys));
            action->setStatusTip(translated(spec.tip));
            action->setCheckable(spec.isCheckable);
            window->addAction(action);
            actions_.insert(QLatin1String(spec.id), action);
            iconNames_.insert(QLatin1String(spec.id), QLatin1String(spec.icon));
            section.actions.push_back(action);
        }
        sections_.push_back(std::move(section));
    }
    refreshIcons();
}

QAction* ActionRegistry::action(const char* id) const {
    QAction* found = actions_.value(QLatin1String(id));
    ISO_CHECK(found != nullptr);
    return found;
}

void ActionRegistry::refreshIcons() {
    for (auto entry = actions_.cbegin(); entry != actions_.cend(); ++entry) {
        const QString name = iconNames_.value(entry.key());
        if (!name.isEmpty())
            entry.value()->setIcon(themedIcon(name, window_->palette()));
    }
}

} // namespace isoslider::widgets
