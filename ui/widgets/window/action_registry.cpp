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
        {TR("Edit"),
         {{"edit.undo", TR("&Undo"), "Ctrl+Z", TR("Take the last change of isovalue, view, slices or pieces back"), ""},
          {"edit.redo", TR("&Redo"), "Ctrl+Shift+Z Ctrl+Y", TR("Make the change again that was taken back"), ""}}},
        {TR("Isovalue"),
         {{"isovalue.edit", TR("&Type an Isovalue"), "Ctrl+L", TR("Type an isovalue in data units"), "isovalue"},
          {"isovalue.play", TR("&Play"), "P", TR("Animate the isovalue"), "play", true},
          {"isovalue.logCounts", TR("&Logarithmic Counts"), "L",
           TR("Show the histogram's counts on a logarithmic axis"), "", true},
          {"isovalue.coarserWhileMoving", TR("&Coarser While Moving"), "",
           TR("Fewer triangles while the handle is held, all of them when it rests"), "", true},
          {"isovalue.clipCounts", TR("Clip &Dominating Counts"), "",
           TR("On a linear axis, let a few counts far above all others leave the histogram at its top"), "", true},
          {"isovalue.linearValues", TR("&Linear"), "", TR("Values stand evenly along the axis"), "", true},
          {"isovalue.logValues", TR("L&ogarithmic"), "", TR("Values stand along the axis by their logarithm"), "",
           true},
          {"isovalue.symlogValues", TR("&Symmetric Logarithmic"), "",
           TR("By the logarithm on both sides of 0, evenly close to it"), "", true},
          {"isovalue.snapToSamples", TR("Snap to S&ample Values"), "",
           TR("Drags and steps lead to values that samples have; not while Shift is held"), "", true},
          {"isovalue.zoomIn", TR("Zoom &In"), "Ctrl++ Ctrl+=", TR("Zoom the histogram in, at the handle"), ""},
          {"isovalue.zoomOut", TR("Zoom &Out"), "Ctrl+-", TR("Zoom the histogram out"), ""},
          {"isovalue.resetZoom", TR("Usual &Range"), "Ctrl+0",
           TR("Show the histogram's range without extreme outliers and fill values"), "fit"},
          {"isovalue.wholeRange", TR("Whol&e Range"), "Ctrl+Shift+0",
           TR("Show the histogram's whole range, with outliers and fill values"), ""},
          {"isovalue.showHandle", TR("Show &Handle"), "Ctrl+H", TR("Bring the isovalue handle into view"), ""},
          {"isovalue.previousEvent", TR("Pre&vious Event"), "[", TR("Move to the previous event of the topology"), ""},
          {"isovalue.nextEvent", TR("&Next Event"), "]", TR("Move to the next event of the topology"), ""},
          {"isovalue.snap", TR("&Snap to Events"), "",
           TR("A drag near the mark of an event goes just past it; not while Shift is held"), "", true},
          {"isovalue.markPassed", TR("Mar&k Passed Events"), "",
           TR("Point out for a moment what a slide just changed: the most persistent event on the way"), "", true},
          {"isovalue.clearEvent", TR("&Unmark Event"), "Esc", TR("Take away the mark of the chosen event"), ""},
          {"isovalue.find", TR("&Find Isovalues…"), "Ctrl+F",
           TR("Find the isovalues whose surface has so many pieces, an area, or a volume"), ""},
          {"isovalue.compare", TR("Compare &with This Isovalue"), "D",
           TR("Keep this isovalue as the reference: what lies between it and others is counted while sliding"), ""},
          {"isovalue.stopComparing", TR("Stop Co&mparing"), "Shift+D", TR("Forget the reference isovalue"), ""}}},
        {TR("Mesh"),
         {{"mesh.check", TR("&Check Mesh"), "Ctrl+K", TR("Check that the surface is manifold, closed and oriented"),
           "check"},
          {"mesh.export", TR("&Export Mesh…"), "Ctrl+E", TR("Write the active surface to a mesh file"), "export"},
          {"index.build", TR("&Build Index"), "", TR("Build the index again after a failure or a cancel"), "build"},
          {"index.cache", TR("&Index Cache…"), "", TR("How much of the disk kept indexes take, and may take"), ""}}},
        {TR("View"),
         {{"view.reset", TR("&Reset View"), "R", TR("Show the whole volume, from the first direction"), ""},
          {"view.fit", TR("&Fit to Surfaces"), "F Shift+R",
           TR("Show all of the surfaces that are shown, as large as it fits"), "fit"},
          {"view.front", TR("&Front"), "1", TR("Look along +Y"), ""},
          {"view.back", TR("&Back"), "Ctrl+1", TR("Look along −Y"), ""},
          {"view.right", TR("R&ight"), "3", TR("Look along −X"), ""},
          {"view.left", TR("&Left"), "Ctrl+3", TR("Look along +X"), ""},
          {"view.top", TR("&Top"), "7", TR("Look along −Z"), ""},
          {"view.bottom", TR("B&ottom"), "Ctrl+7", TR("Look along +Z"), ""},
          {"view.perspective", TR("&Perspective"), "5", TR("Perspective or orthographic projection"), "perspective",
           true},
          {"view.changed", TR("Retrian&gulated Cells"), "G", TR("Marks red what the last move retriangulated"),
           "highlight", true},
          {"view.edges", TR("Triangle &Edges"), "W", TR("Show the edges of the surface's triangles"), "edges", true},
          {"view.levels", TR("Cell Si&zes"), "C", TR("Colour merged cells by their size"), "", true},
          {"view.box", TR("&Bounding Box"), "B", TR("Show the volume's bounding box"), "box", true},
          {"view.axes", TR("Orientation &Axes"), "A", TR("Show the directions of X, Y and Z"), "axes", true},
          {"view.readout", TR("Rea&dout"), "T", TR("Show isovalue, triangles and milliseconds in the view"), "readout",
           true},
          {"view.cube", TR("&Orientation Cube"), "K",
           TR("Show a cube that turns with the view; a click on a side shows it straight on"), "", true},
          {"view.scaleBar", TR("S&cale Bar"), "Shift+K", TR("Show a length in the middle of the view to compare with"),
           "", true},
          {"view.ticks", TR("A&xes with Ticks"), "Shift+A",
           TR("Show places along the edges of the volume's box, in units of length"), "", true},
          {"view.measure", TR("&Measure"), "M",
           TR("Click two places on the surface for the length between them, a third for the angle"), "", true},
          {"clip.crop", TR("&Crop Box"), "Shift+B", TR("Show what lies in a box; its faces are dragged in the view"),
           "", true},
          {"clip.resetCrop", TR("&Reset Crop Box"), "", TR("Let the crop box hold the whole volume"), ""},
          {"clip.plane", TR("Clip &Plane"), "V", TR("Cut the surface open; the plane is moved and turned in the view"),
           "", true},
          {"clip.second", TR("Seco&nd Plane"), "Ctrl+Alt+V",
           TR("Cut by a second plane, too; while this is checked, keys, fields and handles move that one"), "", true},
          {"clip.acrossX", TR("Across &X"), "", TR("Put the clip plane across X, in the middle"), ""},
          {"clip.acrossY", TR("Across &Y"), "", TR("Put the clip plane across Y, in the middle"), ""},
          {"clip.acrossZ", TR("Across &Z"), "", TR("Put the clip plane across Z, in the middle"), ""},
          {"clip.facing", TR("&Facing the View"), "Ctrl+Shift+V",
           TR("Turn the clip plane to where the view looks from"), ""},
          {"clip.flip", TR("F&lip"), "Shift+V", TR("Show the other side of the clip plane"), ""},
          {"clip.noCap", TR("&Hollow"), "", TR("Leave the cut open"), "", true},
          {"clip.colourCap", TR("Filled with C&olour"), "", TR("Fill the inside of the surface on the clip plane"), "",
           true},
          {"clip.valueCap", TR("Filled with &Samples"), "",
           TR("Show the samples inside the surface on the clip plane, in grey"), "", true},
          {"clip.exportClosed", TR("Export Close&d Crop…"), "",
           TR("Write the surface in the crop box, closed at its sides, to a mesh file"), ""},
          {"stage.dark", TR("&Dark"), "", TR("A dark background"), "", true},
          {"stage.light", TR("&Light"), "", TR("A light background"), "", true},
          {"stage.white", TR("&White"), "", TR("A white background, for print"), "", true},
          {"stage.black", TR("&Black"), "", TR("A black background"), "", true},
          {"stage.studio", TR("&Studio"), "", TR("Light from above left, with a fill from below right"), "", true},
          {"stage.headlight", TR("&Headlight"), "", TR("Light from the viewer, without a preferred side"), "", true},
          {"stage.raking", TR("&Raking"), "", TR("Low light from the left, which shows relief"), "", true},
          {"stage.occlusion", TR("&Ambient Occlusion"), "",
           TR("Darken hollows and gaps, as if light came from all sides"), "", true},
          {"stage.stretch", TR("S&tretch Axes…"), "Ctrl+Shift+A",
           TR("Draw lengths along an axis longer or shorter, as for degrees by metres"), ""},
          {"colour.one", TR("&One Colour"), "", TR("Show each surface in its own colour"), "", true},
          {"colour.gradient", TR("&Gradient Magnitude"), "", TR("Colour by how steeply the values change"), "", true},
          {"colour.x", TR("&X"), "", TR("Colour by the place along X"), "", true},
          {"colour.y", TR("&Y"), "", TR("Colour by the place along Y"), "", true},
          {"colour.z", TR("&Z"), "", TR("Colour by the place along Z"), "", true},
          {"colour.middle", TR("&Distance from Middle"), "", TR("Colour by the distance from the volume's middle"), "",
           true},
          {"colour.field", TR("Second &Field…"), "", TR("Colour by the values of another file on the same grid"), "",
           true},
          {"colour.viridis", TR("&Viridis"), "", TR("Colours from dark blue over green to yellow"), "", true},
          {"colour.magma", TR("&Magma"), "", TR("Colours from black over red to pale yellow"), "", true},
          {"colour.cividis", TR("C&ividis"), "", TR("Colours from blue to yellow, alike for the colour-blind"), "",
           true},
          {"colour.blueWhiteRed", TR("&Blue White Red"), "", TR("Colours that part at the middle of the range"), "",
           true},
          {"colour.grey", TR("Gr&ey"), "", TR("Greys from dark to light"), "", true},
          {"colour.reverse", TR("&Reverse"), "", TR("Swap the ends of the colour map"), "", true},
          {"colour.automatic", TR("&Automatic Range"), "", TR("Let the colours span the values of the volume"), "",
           true},
          {"colour.fit", TR("Fit to &Surface"), "", TR("Let the colours span the values on the active surface"), ""},
          {"colour.bar", TR("Co&lour Bar"), "", TR("Show in the view which colour stands for which value"), "", true},
          {"view.fullScreen", TR("F&ull Screen"), "F11", TR("Fill the screen with the window"), "", true},
          {"view.resetLayout", TR("Reset &Layout"), "", TR("Put all panels back in their places"), ""}}},
        {TR("Slices"),
         {{"slices.none", TR("&3-D View Only"), "F5", TR("No slices beside the 3-D view"), "", true},
          {"slices.one", TR("&One Slice"), "F6", TR("The 3-D view and one slice beside it"), "", true},
          {"slices.three", TR("&Three Slices"), "F7", TR("The 3-D view and slices across all three axes"), "", true},
          {"slices.four", TR("&2 × 2"), "F8", TR("The 3-D view and three slices, all of one size"), "", true},
          {"slices.paneX", TR("Across &X"), "X", TR("One slice beside the 3-D view, across X"), "", true},
          {"slices.paneY", TR("Across &Y"), "Y", TR("One slice beside the 3-D view, across Y"), "", true},
          {"slices.paneZ", TR("Across &Z"), "Z", TR("One slice beside the 3-D view, across Z"), "", true},
          {"slices.paneOblique", TR("O&blique"), "O", TR("The oblique slice beside the 3-D view"), "", true},
          {"slices.sceneX", TR("Across &X"), "Shift+X", TR("The slice across X in the 3-D view"), "", true},
          {"slices.sceneY", TR("Across &Y"), "Shift+Y", TR("The slice across Y in the 3-D view"), "", true},
          {"slices.sceneZ", TR("Across &Z"), "Shift+Z", TR("The slice across Z in the 3-D view"), "", true},
          {"slices.sceneOblique", TR("O&blique"), "Shift+O", TR("The oblique slice in the 3-D view"), "", true},
          {"slices.facing", TR("Oblique Slice &Facing the View"), "Shift+F",
           TR("Turn the oblique slice to where the 3-D view looks from, and show it"), ""},
          {"slices.next", TR("&Next Slice"), ".", TR("One slice on, in the pane used last"), ""},
          {"slices.previous", TR("&Previous Slice"), ",", TR("One slice back, in the pane used last"), ""},
          {"slices.centre", TR("C&entre Crosshair"), "Shift+C", TR("Let the slices meet in the middle of the volume"),
           ""},
          {"slices.isovalue", TR("&Isovalue at Crosshair"), "I", TR("Show the surface through the crosshair"), ""},
          {"slices.automaticWindow", TR("&Automatic Window"), "", TR("Black to white over 99 percent of the samples"),
           ""},
          {"slices.wholeWindow", TR("&Whole Range"), "", TR("Black to white over the whole range of values"), ""},
          {"slices.contour", TR("Contou&r"), "", TR("Draw the surface's contour on slices"), "", true},
          {"slices.crosshair", TR("Cross&hair"), "", TR("Show where the other slices cross"), "", true}}},
        {TR("Pieces"),
         {{"pieces.colour", TR("&Colour Pieces"), "Shift+P", TR("Each piece of the surface in a separate colour"), "",
           true},
          {"pieces.hide", TR("&Hide Piece"), "H", TR("Hide the selected piece"), ""},
          {"pieces.only", TR("Show &Only This Piece"), "Shift+H", TR("Hide all pieces but the selected one"), ""},
          {"pieces.hideSmaller", TR("Hide S&maller Than This"), "",
           TR("Hide all pieces whose longest side is shorter than that of the selected one"), ""},
          {"pieces.largest", TR("Keep the &Largest"), "", TR("Hide all pieces but the one of most triangles"), ""},
          {"pieces.all", TR("Show &All Pieces"), "Ctrl+Shift+H", TR("Show what was hidden"), ""},
          {"pieces.deselect", TR("&Deselect Piece"), "", TR("No piece stands out any more"), ""},
          {"pieces.exportShown", TR("&Export What Is Shown…"), "Ctrl+Shift+E",
           TR("Write the surface without what is hidden or clipped to a mesh file"), ""},
          {"pieces.exportSelected", TR("Export &Selected Piece…"), "", TR("Write the selected piece to a mesh file"),
           ""}}},
        {TR("Surfaces"),
         {{"surfaces.add", TR("&Add Surface"), "Ins", TR("Show another surface beside this one, and slide it"), ""},
          {"surfaces.remove", TR("&Remove Surface"), "Shift+Del", TR("Remove the active surface"), ""},
          {"surfaces.next", TR("&Next Surface"), "N", TR("Slide the next surface of the list"), ""},
          {"surfaces.previous", TR("&Previous Surface"), "Shift+N", TR("Slide the surface before it in the list"), ""},
          {"surfaces.show", TR("&Show Surface"), "S", TR("Show or hide the active surface"), "", true},
          {"surfaces.moreOpaque", TR("M&ore Opaque"), "Shift+U", TR("See less through the active surface"), ""},
          {"surfaces.lessOpaque", TR("&Less Opaque"), "U", TR("See more through the active surface"), ""},
          {"surfaces.rename", TR("R&ename…"), "F2", TR("Type a name for the active surface"), ""},
          {"second.open", TR("Open Second Vol&ume…"), "Ctrl+Alt+O",
           TR("Show surfaces of another volume in the same space, beside those of this one"), ""},
          {"second.addSurface", TR("A&dd Surface"), "Alt+Ins", TR("Show another surface of the second volume"), ""},
          {"second.removeSurface", TR("Remo&ve Surface"), "Alt+Shift+Del",
           TR("Remove the selected surface of the second volume"), ""},
          {"second.close", TR("&Close Second Volume"), "Ctrl+Alt+W", TR("Take the second volume out of the view"),
           ""}}},
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

QString tipWithShortcut(const QString& tip, const QList<QKeySequence>& keys) {
    if (keys.isEmpty())
        return tip;
    return QStringLiteral("%1 (%2)").arg(tip, keys.first().toString(QKeySequence::NativeText));
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
            action->setToolTip(tipWithShortcut(translated(spec.tip), keys));
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

void nameAction(QAction& action, const QString& text, const QString& tip) {
    action.setText(text);
    action.setStatusTip(tip);
    action.setToolTip(tipWithShortcut(tip, action.shortcuts()));
}

void ActionRegistry::refreshIcons() {
    for (auto entry = actions_.cbegin(); entry != actions_.cend(); ++entry) {
        const QString name = iconNames_.value(entry.key());
        if (!name.isEmpty())
            entry.value()->setIcon(themedIcon(name, window_->palette()));
    }
}

} // namespace isoslider::widgets
