// What dialogs for files are given: folder, name, suffix and filters.
#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QPushButton>
#include <QSpinBox>
#include <QTest>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

class FileDialogsTest : public WindowTest {
protected:
    /// Asks and answers with a file that is not there.
    AnsweringDialogs::Asked askedBy(const char* action, const fs::path& answer) {
        dialogs_.answers.push_back(qpath(answer));
        trigger(action);
        return dialogs_.asked;
    }
    /// The real dialog that the window opens.
    QFileDialog* shownDialog() {
        auto* dialog = window_->findChild<QFileDialog*>();
        EXPECT_NE(dialog, nullptr);
        return dialog;
    }
};

TEST_F(FileDialogsTest, OpeningBeginsWhereItWasLast) {
    settings_->set("files/previewsFirst", false);
    fs::create_directories(folder_ / "volumes");
    auto asked = askedBy("file.open", folder_ / "volumes/none.mha");
    EXPECT_EQ(asked.title, QStringLiteral("Open Volume"));
    EXPECT_EQ(asked.place, QString());
    EXPECT_EQ(asked.filters, widgets::volumeAndSessionFilters());
    asked = askedBy("file.openFolder", folder_ / "volumes/none");
    EXPECT_EQ(asked.place, qpath(folder_ / "volumes"));
    asked = askedBy("file.open", folder_ / "none.mha");
    EXPECT_EQ(asked.place, qpath(folder_ / "volumes"));
    asked = askedBy("file.openSession", folder_ / "none.isosession");
    EXPECT_EQ(asked.filters, widgets::sessionFilters());
    EXPECT_TRUE(waitUntilSettled());
}

TEST_F(FileDialogsTest, AMeshIsNamedForItsVolumeAndIsovalueInTheLastFolder) {
    openBall();
    session_->isovalue().request(-6.5);
    ASSERT_TRUE(waitUntilSettled());
    auto asked = askedBy("mesh.export", folder_ / "a.ply");
    EXPECT_EQ(asked.place, QDir::home().filePath(QStringLiteral("ball_-6.5.ply")));
    EXPECT_EQ(asked.filters, widgets::meshFilters());
    ASSERT_TRUE(waitUntilSettled());
    asked = askedBy("mesh.export", folder_ / "b.ply");
    EXPECT_EQ(asked.place, qpath(folder_ / "ball_-6.5.ply"));
    ASSERT_TRUE(waitUntilSettled());
}

TEST_F(FileDialogsTest, ASessionLiesBesideItsVolume) {
    openBall();
    const auto asked = askedBy("file.saveSession", folder_ / "s.isosession");
    EXPECT_EQ(asked.place, qpath(folder_ / "ball.isosession"));
    EXPECT_EQ(asked.filters, widgets::sessionFilters());
    EXPECT_TRUE(waitUntil([this] { return fs::exists(folder_ / "s.isosession"); }));
}

TEST_F(FileDialogsTest, APictureIsAPng) {
    openBall();
    if (!window_->actions().action("file.saveImage")->isEnabled())
        GTEST_SKIP() << "no OpenGL 3.3 here";
    const auto asked = askedBy("file.saveImage", folder_ / "view.png");
    EXPECT_EQ(QFileInfo(asked.place).suffix(), QStringLiteral("png"));
    EXPECT_TRUE(asked.filters.contains(QStringLiteral("(*.png)")));
    EXPECT_TRUE(waitUntil([this] { return fs::exists(folder_ / "view.png"); }));
}

TEST_F(FileDialogsTest, EveryFormatHasAFilter) {
    for (const char* suffix : {"*.ply", "*.obj", "*.stl", "*.off", "*.om"})
        EXPECT_TRUE(widgets::meshFilters().contains(QStringLiteral("(%1)").arg(QLatin1String(suffix)))) << suffix;
    const QString all = widgets::volumeFilters().section(QStringLiteral(";;"), 0, 0);
    for (const char* suffix :
         {"*.mha", "*.nrrd", "*.nii.gz", "*.vti", "*.dcm", "*.bin", "*.tiff", "*.nc", "*.mrc", "*.raw", "*.isx"})
        EXPECT_TRUE(all.contains(QLatin1String(suffix))) << suffix;
}

TEST_F(FileDialogsTest, TheSuffixFollowsTheFilter) {
    widgets::PlatformFileDialogs platform;
    QString chosen;
    platform.askSave(window_.get(), QStringLiteral("Export Mesh"), qpath(folder_ / "ball_1.5.ply"),
                     widgets::meshFilters(), [&chosen](const QString& path) { chosen = path; });
    auto* dialog = shownDialog();
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->windowTitle(), QStringLiteral("Export Mesh"));
    EXPECT_EQ(dialog->acceptMode(), QFileDialog::AcceptSave);
    EXPECT_EQ(dialog->directory().absolutePath(), qpath(folder_.path()));
    EXPECT_EQ(dialog->nameFilters(), widgets::meshFilters().split(QStringLiteral(";;")));
    EXPECT_EQ(dialog->defaultSuffix(), QStringLiteral("ply"));
    dialog->selectNameFilter(QStringLiteral("STL (*.stl)"));
    Q_EMIT dialog->filterSelected(QStringLiteral("STL (*.stl)")); // as picking it in the list does
    EXPECT_EQ(dialog->defaultSuffix(), QStringLiteral("stl"));
    Q_EMIT dialog->fileSelected(QStringLiteral("/x.stl"));
    EXPECT_EQ(chosen, QStringLiteral("/x.stl"));
    delete dialog;
}

TEST_F(FileDialogsTest, OnlyWhatIsThereCanBeOpened) {
    widgets::PlatformFileDialogs platform;
    platform.askOpen(window_.get(), QStringLiteral("Open Volume"), qpath(folder_.path()), widgets::volumeFilters(),
                     [](const QString&) {});
    auto* dialog = shownDialog();
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->acceptMode(), QFileDialog::AcceptOpen);
    EXPECT_EQ(dialog->fileMode(), QFileDialog::ExistingFile);
    EXPECT_EQ(dialog->directory().absolutePath(), qpath(folder_.path()));
    delete dialog;
    platform.askFolder(window_.get(), QStringLiteral("Open Folder"), qpath(folder_.path()), [](const QString&) {});
    dialog = shownDialog();
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->fileMode(), QFileDialog::Directory);
    EXPECT_TRUE(dialog->testOption(QFileDialog::ShowDirsOnly));
    delete dialog;
}

TEST_F(FileDialogsTest, APictureIsTheViewSomeTimesLargerOrOfAWidth) {
    widgets::PlatformFileDialogs platform;
    std::optional<widgets::PictureChoice> chosen;
    const auto ask = [&](const widgets::PictureChoice& last) {
        chosen.reset();
        platform.askPicture(window_.get(), last, QSize(800, 500), [&](const auto& choice) { chosen = choice; });
        return window_->findChild<QDialog*>(QStringLiteral("pictureDialog"));
    };
    auto* dialog = ask({});
    ASSERT_NE(dialog, nullptr);
    auto* scale = dialog->findChild<QComboBox*>(QStringLiteral("pictureScale"));
    auto* width = dialog->findChild<QSpinBox*>(QStringLiteral("pictureWidth"));
    EXPECT_EQ(scale->currentIndex(), 0);
    EXPECT_EQ(width->value(), 800);
    EXPECT_FALSE(width->isEnabled());
    scale->setCurrentIndex(2);
    EXPECT_EQ(width->value(), 3200);
    scale->setCurrentIndex(3);
    EXPECT_TRUE(width->isEnabled());
    EXPECT_EQ(width->value(), 1920) << "the last that was typed";
    width->setValue(1000);
    dialog->findChild<QCheckBox*>(QStringLiteral("pictureTransparent"))->setChecked(true);
    keepPicture(*dialog, "picture_dialog");
    dialog->findChild<QPushButton*>(QStringLiteral("pictureSave"))->click();
    ASSERT_TRUE(chosen);
    EXPECT_EQ(*chosen, (widgets::PictureChoice{0, 1000, true}));
    EXPECT_EQ(chosen->sizeOf({800, 500}), QSize(1000, 625));
    delete dialog;
    dialog = ask(*chosen);
    ASSERT_NE(dialog, nullptr);
    EXPECT_EQ(dialog->findChild<QSpinBox*>(QStringLiteral("pictureWidth"))->value(), 1000);
    dialog->reject();
    EXPECT_FALSE(chosen);
    delete dialog;
}

TEST(PictureChoice, KeepsTheProportionsAndALimit) {
    EXPECT_EQ((widgets::PictureChoice{4, 0, false}.sizeOf({801, 333})), QSize(3204, 1332));
    EXPECT_EQ((widgets::PictureChoice{0, 16384, false}.sizeOf({400, 800})), QSize(8192, 16384));
    EXPECT_EQ((widgets::PictureChoice{4, 0, false}.sizeOf({8000, 10})), QSize(16384, 20));
    EXPECT_TRUE((widgets::PictureChoice{1, 0, false}.sizeOf({})).isEmpty());
}

} // namespace
} // namespace isoslider::test
