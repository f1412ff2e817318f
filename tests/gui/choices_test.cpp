// Fields in groups, what is remembered of choices, and units beside lengths.
#include <QAbstractItemModelTester>
#include <QAction>
#include <QDialog>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QTest>

#include "tests/gui/fake_readers.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/opening/field_tree_model.h"
#include "ui/widgets/opening/field_tree_view.h"
#include "ui/widgets/opening/preview_pane.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

using widgets::FieldTreeModel;
using widgets::FieldTreeView;

/// Readers that find what they are told to; samples are a ball whose top reports what was chosen.
class ChoicesTest : public FakeReadersTest {
protected:
    FieldTreeView* openTree(QDialog*& shown) {
        contents_ = groupedContents();
        drop(folder_.write("run.h5", "x"));
        shown = dialog("volumeDialog");
        EXPECT_TRUE(waitForPreview(shown));
        return shown->findChild<FieldTreeView*>(QStringLiteral("volumeFields"));
    }
    static io::VolumeContents groupedContents() {
        io::VolumeContents contents;
        contents.format = "HDF5";
        contents.fields = {fieldOf("/calibration/flat", "", {24, 20, 28}),
                           fieldOf("/run1/density", "", {24, 20, 28}),
                           fieldOf("/run1/raw/counts", "", {24, 20, 28}),
                           fieldOf("/run1/raw/times", "", {1, 1, 1}),
                           fieldOf("/run2/velocity", "", {24, 20, 28}),
                           fieldOf("/run2/a_rather_long_name_of_a_data_set", "", {1024, 1024, 1024})};
        contents.fields[3].problem = "text is not read";
        contents.fields[3].typeName.clear();
        contents.fields[4].components = 3;
        contents.preferred = 1;
        return contents;
    }
    std::string chosen(QDialog* shown) {
        EXPECT_TRUE(waitForPreview(shown));
        QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen")), Qt::LeftButton);
        EXPECT_TRUE(waitForSurface());
        return session_->dataset()->readOptions.field;
    }
    static QString highlighted(const FieldTreeView* view) {
        const auto rows = view->selectionModel()->selectedRows();
        return rows.size() == 1 ? rows.first().data().toString() : QStringLiteral("none or several");
    }
    QAction* recent(const QString& text) {
        for (auto* menu : window_->menuBar()->findChildren<QMenu*>())
            for (auto* action : menu->actions())
                if (action->text().contains(text))
                    return action;
        return nullptr;
    }
    /// As after the program has ended and started again.
    void restart() {
        window_.reset();
        session_.reset();
        settings_ =
            std::make_unique<widgets::SettingsStore>(QString::fromStdString((folder_ / "settings.ini").string()));
        makeWindow();
    }
};

TEST_F(ChoicesTest, DataSetsAreShownInTheirGroups) {
    QDialog* shown = nullptr;
    auto* view = openTree(shown);
    ASSERT_TRUE(view->isVisible());
    const auto* model = view->model();
    ASSERT_EQ(model->rowCount(), 3);
    const auto run1 = model->index(1, 0);
    EXPECT_EQ(run1.data().toString(), QStringLiteral("run1"));
    EXPECT_TRUE(view->isExpanded(run1));
    EXPECT_EQ(model->rowCount(run1), 2);
    EXPECT_EQ(model->index(0, 0, run1).data().toString(), QStringLiteral("density"));
    EXPECT_EQ(model->index(0, 1, run1).data().toString(), QStringLiteral("24 × 20 × 28"));
    EXPECT_EQ(model->index(0, 2, run1).data().toString(), QStringLiteral("int16"));
    EXPECT_EQ(highlighted(view), QStringLiteral("density")) << "what the file puts forward";
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-groups");
    EXPECT_EQ(chosen(shown), "/run1/density");
}

TEST_F(ChoicesTest, TheTitleOfTheWindowNamesTheField) {
    QDialog* shown = nullptr;
    openTree(shown);
    chosen(shown);
    EXPECT_EQ(window_->windowTitle(), QStringLiteral("run.h5 – /run1/density – ISOSLIDER"));
    trigger("file.close");
    EXPECT_EQ(window_->windowTitle(), QStringLiteral("ISOSLIDER"));
}

TEST_F(ChoicesTest, LongNamesOfFilesMakeNoWideDialogs) {
    contents_ = groupedContents();
    const std::string name = std::string(110, 'n') + "_" + std::string(110, 'm');
    const QString hdf5 = QString::fromStdString(name + ".h5");
    drop(folder_.write(name + ".h5", "x"));
    QDialog* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_LE(shown->width(), 1100);
    EXPECT_LE(shown->minimumSizeHint().width(), 1100);
    auto* heading = shown->findChild<QLabel*>(QStringLiteral("fileName"));
    EXPECT_TRUE(heading->text().contains(u'…'));
    EXPECT_TRUE(heading->text().endsWith(QStringLiteral(".h5"))) << "the end states what it is";
    EXPECT_TRUE(heading->toolTip().contains(hdf5));
    keepPicture(*shown, "open-long-name");
    const int before = window_->minimumSizeHint().width();
    chosen(shown);
    keepPicture(*window_, "window-long-name");
    EXPECT_LE(window_->minimumSizeHint().width(), before) << "nor a wide window";
    session_->post({model::Notice::Severity::Error, "Could not open " + name, "/data/" + name + ": is not a volume"});
    QTest::qWait(20);
    EXPECT_LE(window_->minimumSizeHint().width(), before);
    EXPECT_LE(window_->width(), 1400);
    keepPicture(*window_, "message-long-name");
    drop(folder_.write(name + ".raw", std::string(4096, 'x')));
    QDialog* raw = dialog("rawImportDialog");
    QTest::qWait(50);
    EXPECT_LE(raw->minimumSizeHint().width(), 1100);
    EXPECT_TRUE(raw->findChild<QLabel*>(QStringLiteral("fileName"))->text().endsWith(QStringLiteral(".raw")));
    keepPicture(*raw, "raw-long-name");
    raw->reject();
}

TEST_F(ChoicesTest, TheKeysGoThroughTheGroups) {
    QDialog* shown = nullptr;
    auto* view = openTree(shown);
    auto* heading = view->parentWidget()->findChild<QLabel*>(); // "&Fields in this file"
    ASSERT_EQ(heading->buddy(), view);
    QTest::keyClick(shown, Qt::Key_F, Qt::AltModifier);
    EXPECT_TRUE(view->hasFocus());
    QTest::keyClick(view, Qt::Key_Down); // the group "raw"
    EXPECT_EQ(view->currentIndex().data().toString(), QStringLiteral("raw"));
    EXPECT_EQ(highlighted(view), QStringLiteral("density")) << "a group is no choice";
    QTest::keyClick(view, Qt::Key_Left);
    EXPECT_FALSE(view->isExpanded(view->currentIndex()));
    QTest::keyClick(view, Qt::Key_Down); // past what is folded
    EXPECT_EQ(view->currentIndex().data().toString(), QStringLiteral("run2"));
    QTest::keyClick(view, Qt::Key_Up);
    QTest::keyClick(view, Qt::Key_Right);
    QTest::keyClick(view, Qt::Key_Down);
    EXPECT_EQ(highlighted(view), QStringLiteral("counts"));
    keepPicture(*shown, "open-groups-keys");
    EXPECT_EQ(chosen(shown), "/run1/raw/counts");
}

TEST_F(ChoicesTest, TheMouseFoldsGroupsAndOpensDataSets) {
    QDialog* shown = nullptr;
    auto* view = openTree(shown);
    const auto at = [&](const QModelIndex& index) {
        view->scrollTo(index);
        return view->visualRect(index).center();
    };
    const auto run1 = view->model()->index(1, 0), run2 = view->model()->index(2, 0);
    QTest::mouseClick(view->viewport(), Qt::LeftButton, {}, at(run1));
    EXPECT_EQ(highlighted(view), QStringLiteral("density"));
    doubleClick(*view->viewport(), Qt::LeftButton, {}, at(run1));
    EXPECT_FALSE(view->isExpanded(run1)) << "a double click folds a group and opens nothing";
    EXPECT_TRUE(shown->isVisible());
    const auto velocity = view->model()->index(0, 0, run2);
    QTest::mouseClick(view->viewport(), Qt::LeftButton, {}, at(velocity));
    EXPECT_EQ(highlighted(view), QStringLiteral("velocity"));
    ASSERT_TRUE(waitForPreview(shown));
    doubleClick(*view->viewport(), Qt::LeftButton, {}, at(velocity));
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->readOptions.field, "/run2/velocity");
    EXPECT_EQ(session_->dataset()->readOptions.component, 0);
}

TEST_F(ChoicesTest, WhatCannotBeReadIsGreyAndSaysWhy) {
    QDialog* shown = nullptr;
    auto* view = openTree(shown);
    const auto* model = view->model();
    const auto times = model->index(1, 0, model->index(1, 0, model->index(1, 0)));
    ASSERT_EQ(times.data().toString(), QStringLiteral("times – text is not read"));
    EXPECT_TRUE(times.data(Qt::ToolTipRole).toString().contains(QStringLiteral("text is not read")));
    EXPECT_TRUE(times.data(Qt::ForegroundRole).isValid());
    EXPECT_FALSE(model->index(0, 0, model->index(1, 0)).data(Qt::ForegroundRole).isValid());
    QTest::mouseClick(view->viewport(), Qt::LeftButton, {}, view->visualRect(times).center());
    EXPECT_EQ(status(shown), QStringLiteral("text is not read"));
    EXPECT_FALSE(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen"))->isEnabled());
    expectLegible(shown);
    keepPicture(*shown, "open-groups-problem");
}

TEST_F(ChoicesTest, TheOpenFileCanBeOpenedAgainAsItWas) {
    contents_.format = "NetCDF";
    contents_.fields = {fieldOf("temperature", "", {24, 20, 28}), fieldOf("b", "wind speed", {24, 20, 28})};
    contents_.fields[1].frames = 9;
    const auto file = folder_.write("flow.nc", "x");
    drop(file);
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    auto* view = shown->findChild<FieldTreeView*>(QStringLiteral("volumeFields"));
    view->setFocus();
    QTest::keyClick(view, Qt::Key_Down);
    auto* frame = shown->findChild<QSpinBox*>(QStringLiteral("volumeFrame"));
    for (int i = 0; i < 3; ++i)
        QTest::keyClick(frame, Qt::Key_Up);
    EXPECT_EQ(chosen(shown), "b");
    ASSERT_TRUE(isGone("volumeDialog"));
    auto* entry = recent(QStringLiteral("flow.nc – wind speed, frame 3"));
    ASSERT_NE(entry, nullptr);
    drop(file);
    EXPECT_EQ(chosen(dialog("volumeDialog")), "temperature");
    ASSERT_TRUE(isGone("volumeDialog"));
    ASSERT_NE(recent(QStringLiteral("flow.nc – temperature")), nullptr) << "another entry";

    restart();
    keepPicture(*window_, "recent-start-page");
    entry = recent(QStringLiteral("flow.nc – wind speed, frame 3"));
    ASSERT_NE(entry, nullptr);
    EXPECT_TRUE(entry->text().startsWith(QStringLiteral("&2 ")));
    entry->trigger();
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr) << "nothing is asked again";
    EXPECT_EQ(session_->dataset()->readOptions.field, "b");
    EXPECT_EQ(session_->dataset()->readOptions.frame, 3);
    EXPECT_EQ(session_->dataset()->max, 1528.0);
    EXPECT_TRUE(recent(QStringLiteral("flow.nc – wind speed, frame 3"))->text().startsWith(QStringLiteral("&1 ")));
    EXPECT_EQ(settings_->list("files/recent").size(), 2);
    keepPicture(*window_, "dataset-title-unit");
}

TEST_F(ChoicesTest, ChoicesThatAreGoneAreAskedAnew) {
    contents_.format = "NetCDF";
    settings_->set("files/recent",
                   QStringList{qpath(folder_.write("R&D.nc", "x")) + QStringLiteral("\x1f"
                                                                                    R"({"field":"gone"})"
                                                                                    "\x1f")});
    restart();
    auto* entry = recent(QStringLiteral("R&&D.nc – gone"));
    ASSERT_NE(entry, nullptr);
    entry->trigger();
    auto* shown = dialog("volumeDialog");
    ASSERT_NE(shown, nullptr);
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_EQ(chosen(shown), "a");
}

TEST_F(ChoicesTest, DamagedChoicesAreNoChoices) {
    contents_.fields.pop_back();
    settings_->set("files/recent", QStringList{qpath(folder_.write("flow.nc", "x")) +
                                               QStringLiteral("\x1f"
                                                              R"({"field":"gone","frame":"many"})"
                                                              "\x1f")});
    restart();
    auto* start = window_->findChild<QWidget*>(QStringLiteral("startPage"));
    QPushButton* button = nullptr;
    for (auto* one : start->findChildren<QPushButton*>())
        if (one->text().startsWith(QStringLiteral("flow.nc   ")))
            button = one;
    ASSERT_NE(button, nullptr);
    QTest::mouseClick(button, Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->readOptions, io::ReadOptions());
}

TEST_F(ChoicesTest, TheModelOfTheTreeIsSound) {
    FieldTreeModel model(QStringLiteral("Field"));
    const QAbstractItemModelTester tester(&model, QAbstractItemModelTester::FailureReportingMode::Fatal);
    model.setContents(groupedContents());
    for (std::size_t field = 0; field < 6; ++field)
        EXPECT_EQ(model.fieldAt(model.indexOf(field)), field);
    model.setContents(contents_);
    EXPECT_EQ(model.rowCount(), 2);
    contents_.fields[0].title = "<img src='/etc/hostname'> & more";
    model.setContents(contents_);
    const QString tip = model.index(0, 0).data(Qt::ToolTipRole).toString();
    EXPECT_FALSE(tip.contains(QStringLiteral("<img"))) << tip.toStdString();
}

TEST_F(ChoicesTest, TitleAndUnitAreShownInThePanels) {
    contents_.fields.erase(contents_.fields.begin());
    drop(folder_.write("scan.dcm", "x"));
    ASSERT_TRUE(waitForSurface());
    ASSERT_TRUE(waitUntilSettled());
    const auto labelled = [&](const QString& text) {
        for (auto* label : window_->findChildren<QLabel*>())
            if (label->text() == text)
                return label;
        return static_cast<QLabel*>(nullptr);
    };
    auto* title = labelled(QStringLiteral("5: T2 FLAIR axial"));
    ASSERT_NE(title, nullptr);
    EXPECT_EQ(title->toolTip(), QStringLiteral("b"));
    const QString unit = QChar(QChar::Nbsp) + QStringLiteral("mm");
    EXPECT_NE(labelled(QStringLiteral("1 × 1 × 1") + unit), nullptr) << "spacing";
    EXPECT_NE(labelled(QStringLiteral("L 0, P 0, S 0") + unit), nullptr) << "origin";
    EXPECT_NE(labelled(QStringLiteral("23 × 19 × 27") + unit), nullptr) << "box";
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([&] { return session_->certificate().has_value(); }));
    const auto powers = [&](const QString& power) {
        for (auto* label : window_->findChildren<QLabel*>())
            if (label->text().endsWith(unit + power))
                return true;
        return false;
    };
    EXPECT_TRUE(powers(QStringLiteral("²")));
    EXPECT_TRUE(powers(QStringLiteral("³")));
    keepPicture(*window_, "panels-title-unit");
    const fs::path index = session_->dataset()->indexPath;
    fs::copy_file(index, folder_ / "copy.isx");
    window_->openFile(qpath(folder_ / "copy.isx"));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset()->name == "copy.isx"; }));
    EXPECT_EQ(session_->dataset()->lengthUnit, "mm") << "the index knows it";
}

class RecentRawTest : public OpenFlowTest {};

TEST_F(RecentRawTest, ARawLayoutIsRemembered) {
    std::string bytes;
    for (const auto sample : ballSamples<std::uint8_t>({20, 18, 16}, 250.0))
        bytes += static_cast<char>(sample);
    window_->openFile(qpath(folder_.write("scan.raw", bytes)));
    auto* shown = dialog("rawImportDialog");
    ASSERT_TRUE(waitForPreview(shown));
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("rawOpen")), Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    ASSERT_TRUE(waitUntilSettled());
    const auto options = session_->dataset()->readOptions;
    ASSERT_TRUE(isGone("rawImportDialog"));
    makeWindow();
    QAction* entry = nullptr;
    for (auto* menu : window_->menuBar()->findChildren<QMenu*>())
        for (auto* action : menu->actions())
            if (action->text().contains(QStringLiteral("scan.raw – 20x18x16 u8")))
                entry = action;
    ASSERT_NE(entry, nullptr);
    entry->trigger();
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr);
    EXPECT_EQ(session_->dataset()->readOptions, options);
}

} // namespace
} // namespace isoslider::test
