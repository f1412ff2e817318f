// From a file or folder to an open volume: previews, choices, raw samples, cancelling.
#include <QCheckBox>
#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QTableView>
#include <QTest>
#include <QTreeView>

#include "tests/gui/fake_readers.h"
#include "ui/widgets/opening/preview_pane.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

TEST_F(OpenFlowTest, AFileIsShownBeforeItIsOpened) {
    dialogs_.answers.push_back(qpath(writeBall(folder_, "ball.mha", 40)));
    trigger("file.open");
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_EQ(session_->dataset(), nullptr);
    EXPECT_TRUE(status(shown).startsWith(QStringLiteral("All samples: values -33"))) << status(shown).toStdString();
    EXPECT_FALSE(shown->findChild<QTreeView*>(QStringLiteral("volumeFields"))->isVisible()) << "one field is no choice";
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-volume");
    QTest::keyClick(shown, Qt::Key_Return);
    ASSERT_TRUE(waitForSurface());
    EXPECT_TRUE(isGone("volumeDialog"));
    EXPECT_EQ(session_->dataset()->name, "ball.mha");
    EXPECT_EQ(session_->dataset()->readOptions, io::ReadOptions());
}

TEST_F(OpenFlowTest, PreviewsCanBeTurnedOffAndOnAgain) {
    const auto ball = writeBall(folder_, "ball.mha", 16);
    dialogs_.answers.push_back(qpath(ball));
    trigger("file.open");
    auto* shown = dialog("volumeDialog");
    QTest::mouseClick(shown->findChild<QCheckBox*>(QStringLiteral("previewsFirst")), Qt::LeftButton, {}, QPoint(8, 8));
    EXPECT_FALSE(window_->actions().action("file.previewsFirst")->isChecked());
    QTest::keyClick(shown, Qt::Key_Escape);
    ASSERT_TRUE(isGone("volumeDialog"));
    EXPECT_EQ(session_->dataset(), nullptr);
    dialogs_.answers.push_back(qpath(ball));
    trigger("file.open");
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr);
    trigger("file.previewsFirst");
    dialogs_.answers.push_back(qpath(ball));
    trigger("file.open");
    EXPECT_NE(dialog("volumeDialog"), nullptr);
}

TEST_F(OpenFlowTest, ABadFileIsToldInTheDialogAndTheOldVolumeStays) {
    openBall();
    const auto frame = session_->frame();
    dialogs_.answers.push_back(
        qpath(folder_.write("bad.mha", "ObjectType = Image\nNDims = 3\nDimSize = 4 4 bananas\n")));
    trigger("file.open");
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitUntil([&] { return status(shown).contains(QStringLiteral("bad.mha")); }));
    EXPECT_FALSE(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen"))->isEnabled());
    expectLegible(shown);
    keepPicture(*shown, "open-bad-file");
    QTest::keyClick(shown, Qt::Key_Escape);
    EXPECT_TRUE(isGone("volumeDialog"));
    EXPECT_EQ(session_->frame(), frame);
    session_->isovalue().request(-5.0);
    EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -5.0; }));
}

TEST_F(FakeReadersTest, AFolderOfSeveralSeriesAsksWhich) {
    fs::create_directory(folder_ / "study");
    drop(folder_ / "study");
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_EQ(shown->windowTitle(), QStringLiteral("Open Folder"));
    auto* series = shown->findChild<QTreeView*>(QStringLiteral("volumeFields"));
    ASSERT_TRUE(series->isVisible());
    EXPECT_EQ(series->model()->rowCount(), 2);
    EXPECT_EQ(series->model()->index(1, 0).data().toString(), QStringLiteral("5: T2 FLAIR axial"));
    EXPECT_EQ(series->model()->index(0, 1).data().toString(), QStringLiteral("24 × 20 × 28"));
    EXPECT_FALSE(window_->messageBar().isVisible()) << "a choice is no error";
    series->setFocus();
    QTest::keyClick(series, Qt::Key_Down);
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_TRUE(status(shown).endsWith(QStringLiteral("1498"))) << status(shown).toStdString();
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-series");
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen")), Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->readOptions.field, "b");
    EXPECT_EQ(session_->dataset()->max, 1498.0);
}

// As a file does: dropped, and where previews are not wanted.
TEST_F(FakeReadersTest, AFolderOfOneSeriesOpensAtOnceWhereNoPreviewIsWanted) {
    contents_.fields.pop_back();
    fs::create_directory(folder_ / "study");
    fs::create_directory(folder_ / "dropped");
    settings_->set("files/previewsFirst", false);
    dialogs_.answers.push_back(qpath(folder_ / "study"));
    trigger("file.openFolder");
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr);
    EXPECT_EQ(session_->dataset()->name, "study");
    settings_->set("files/previewsFirst", true);
    drop(folder_ / "dropped");
    ASSERT_TRUE(waitUntil([this] { return session_->dataset()->name == "dropped"; }));
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr);
}

TEST_F(FakeReadersTest, AFolderOfOneSeriesHasAPreview) {
    contents_.fields.pop_back();
    fs::create_directory(folder_ / "study");
    dialogs_.answers.push_back(qpath(folder_ / "study"));
    trigger("file.openFolder");
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_EQ(shown->windowTitle(), QStringLiteral("Open Folder"));
    EXPECT_EQ(session_->dataset(), nullptr);
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-one-series");
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen")), Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->name, "study");
}

TEST_F(FakeReadersTest, ComponentAndFrameAreChosenWithTheKeys) {
    contents_.fields.pop_back();
    contents_.fields[0].components = 3;
    contents_.fields[0].componentNames = {"u", "v", "w"};
    contents_.fields[0].frames = 4;
    drop(folder_.write("flow.nc", "x"));
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    auto* component = shown->findChild<QComboBox*>(QStringLiteral("volumeComponent"));
    auto* frame = shown->findChild<QSpinBox*>(QStringLiteral("volumeFrame"));
    ASSERT_TRUE(component->isVisible() && frame->isVisible());
    EXPECT_EQ(component->count(), 4) << "three and their magnitude";
    QTest::keyClick(component, Qt::Key_Down);
    QTest::keyClick(component, Qt::Key_Down);
    QTest::keyClick(frame, Qt::Key_Up);
    QTest::keyClick(frame, Qt::Key_Up);
    QTest::keyClick(frame, Qt::Key_Up);
    QTest::keyClick(frame, Qt::Key_Up); // there are but four
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_TRUE(status(shown).endsWith(QStringLiteral("1228"))) << status(shown).toStdString();
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-component-frame");
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("volumeOpen")), Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->readOptions.component, 2);
    EXPECT_EQ(session_->dataset()->readOptions.frame, 3);
}

TEST_F(FakeReadersTest, AGridThatIsNotUniformIsOfferedASize) {
    contents_.fields.pop_back();
    contents_.fields[0].isResampled = true;
    contents_.fields[0].dims = {100, 80, 40};
    dialogs_.answers.push_back(qpath(folder_.write("fin.vts", "x")));
    trigger("file.open");
    auto* shown = dialog("volumeDialog");
    ASSERT_TRUE(waitForPreview(shown));
    auto* size = shown->findChild<QSpinBox*>(QStringLiteral("volumeSizeX"));
    ASSERT_TRUE(size->isVisible());
    EXPECT_EQ(size->value(), 100);
    size->setFocus();
    size->selectAll();
    QTest::keyClicks(size, QStringLiteral("50"));
    QTest::keyClick(size, Qt::Key_Tab);
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_TRUE(status(shown).startsWith(QStringLiteral("Resampled to 64 × 51 × 26"))) << status(shown).toStdString();
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "open-resampled");
    QTest::keyClick(shown, Qt::Key_Return);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->readOptions.resampleDims, (GridDims{50, 80, 40}));
    EXPECT_EQ(session_->dataset()->geometry.dims, (GridDims{50, 80, 40}));
}

TEST_F(FakeReadersTest, OpeningIsCancelledFromTheCard) {
    contents_.fields.pop_back();
    drop(folder_.write("first.nc", "x"));
    ASSERT_TRUE(waitForSurface());
    ASSERT_TRUE(waitUntilSettled());
    const auto frame = session_->frame();
    isHeld_ = true;
    drop(folder_.write("second.nc", "x"));
    auto* cancel = child<QPushButton>("cancelOpening");
    ASSERT_TRUE(waitUntil([&] { return cancel->isVisible(); }));
    EXPECT_TRUE(child<QLabel>("loadingLabel")->text().contains(QStringLiteral("second.nc")));
    keepPicture(*window_, "opening");
    QTest::mouseClick(cancel, Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return !session_->isLoading(); }));
    EXPECT_FALSE(child<QWidget>("loadingCard")->isVisible());
    EXPECT_FALSE(window_->messageBar().isVisible());
    EXPECT_EQ(session_->dataset()->name, "first.nc");
    EXPECT_EQ(session_->frame(), frame);
}

TEST_F(FakeReadersTest, EscapeCancelsOpening) {
    contents_.fields.pop_back();
    isHeld_ = true;
    drop(folder_.write("first.nc", "x"));
    ASSERT_TRUE(waitUntil([&] { return child<QPushButton>("cancelOpening")->isVisible(); }));
    QTest::keyClick(window_.get(), Qt::Key_Escape);
    ASSERT_TRUE(waitUntil([&] { return !session_->isLoading(); }, std::chrono::seconds(5)));
    EXPECT_EQ(session_->dataset(), nullptr);
    EXPECT_FALSE(window_->messageBar().isVisible());
}

class RawImportTest : public OpenFlowTest {
protected:
    QDialog* openRaw(const char* name, const std::string& bytes) {
        window_->openFile(qpath(folder_.write(name, bytes)));
        return dialog("rawImportDialog");
    }
    template <class T>
    static std::string raw(const std::vector<T>& samples, bool isSwapped) {
        std::string bytes(reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(T));
        for (std::size_t i = 0; isSwapped && i < bytes.size(); i += sizeof(T))
            std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                         bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(T)));
        return bytes;
    }
};

TEST_F(RawImportTest, TheBestGuessIsShownAndOpens) {
    auto* shown = openRaw("scan.raw", raw(ballSamples<std::uint16_t>({40, 36, 28}, 3000.0), true));
    auto* guesses = shown->findChild<QTableView*>(QStringLiteral("rawGuesses"));
    ASSERT_TRUE(waitUntil([&] { return guesses->model()->rowCount() > 0; }));
    ASSERT_TRUE(waitForPreview(shown));
    EXPECT_EQ(guesses->currentIndex().row(), 0);
    EXPECT_EQ(shown->findChild<QSpinBox*>(QStringLiteral("rawDimX"))->value(), 40);
    EXPECT_EQ(shown->findChild<QSpinBox*>(QStringLiteral("rawDimZ"))->value(), 28);
    EXPECT_TRUE(shown->findChild<QCheckBox*>(QStringLiteral("rawBigEndian"))->isChecked());
    EXPECT_FALSE(shown->findChild<QWidget*>(QStringLiteral("rawSwapWarning"))->isVisible());
    expectLegible(shown);
    expectNamed(shown);
    keepPicture(*shown, "raw-import");
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("rawOpen")), Qt::LeftButton);
    ASSERT_TRUE(waitForSurface());
    EXPECT_EQ(session_->dataset()->geometry.dims, (GridDims{40, 36, 28}));
    EXPECT_LE(session_->dataset()->max, 3000.0);
    EXPECT_TRUE(waitUntilSettled());
}

TEST_F(RawImportTest, TypedDimsAreShownLiveAndTheFitIsTold) {
    auto* shown = openRaw("scan.raw", raw(ballSamples<std::uint8_t>({20, 18, 16}, 250.0), false));
    ASSERT_TRUE(waitForPreview(shown));
    auto* open = shown->findChild<QPushButton*>(QStringLiteral("rawOpen"));
    auto* fit = shown->findChild<QLabel*>(QStringLiteral("rawFit"));
    auto* depth = shown->findChild<QSpinBox*>(QStringLiteral("rawDimZ"));
    auto* guesses = shown->findChild<QTableView*>(QStringLiteral("rawGuesses"));
    depth->setFocus();
    QTest::keyClick(depth, Qt::Key_Up);
    EXPECT_FALSE(open->isEnabled());
    EXPECT_TRUE(fit->text().contains(QStringLiteral("the file is 360 short"))) << fit->text().toStdString();
    EXPECT_FALSE(guesses->currentIndex().isValid());
    QTest::keyClick(depth, Qt::Key_Down);
    QTest::keyClick(depth, Qt::Key_Down);
    EXPECT_TRUE(fit->text().contains(QStringLiteral("the file has 360 more"))) << fit->text().toStdString();
    EXPECT_FALSE(open->isEnabled());
    ASSERT_TRUE(waitUntil([&] { return status(shown).startsWith(QStringLiteral("All samples")); }))
        << "seen all the same";
    auto* trailing = shown->findChild<QCheckBox*>(QStringLiteral("rawTrailing"));
    QTest::mouseClick(trailing, Qt::LeftButton, {}, QPoint(8, trailing->height() / 2));
    EXPECT_TRUE(open->isEnabled());
    keepPicture(*shown, "raw-import-trailing");
    ASSERT_GT(guesses->model()->rowCount(), 1);
    QTest::mouseClick(guesses->viewport(), Qt::LeftButton, {},
                      guesses->visualRect(guesses->model()->index(0, 0)).center());
    EXPECT_EQ(depth->value(), 16);
    EXPECT_TRUE(open->isEnabled());
}

TEST_F(RawImportTest, SwappedBytesAreWarnedOf) {
    auto* shown = openRaw("scan.raw", raw(ballSamples<std::uint16_t>({40, 36, 28}, 3000.0), true));
    ASSERT_TRUE(waitUntil(
        [&] { return shown->findChild<QTableView*>(QStringLiteral("rawGuesses"))->model()->rowCount() > 0; }));
    auto* bigEndian = shown->findChild<QCheckBox*>(QStringLiteral("rawBigEndian"));
    QTest::mouseClick(bigEndian, Qt::LeftButton, {}, QPoint(8, bigEndian->height() / 2));
    ASSERT_FALSE(bigEndian->isChecked());
    auto* warning = shown->findChild<QWidget*>(QStringLiteral("rawSwapWarning"));
    ASSERT_TRUE(waitUntil([&] { return warning->isVisible(); }));
    ASSERT_TRUE(waitForPreview(shown));
    expectLegible(shown);
    keepPicture(*shown, "raw-import-swapped");
    QTest::mouseClick(shown->findChild<QPushButton*>(QStringLiteral("rawSwap")), Qt::LeftButton);
    EXPECT_TRUE(bigEndian->isChecked());
    EXPECT_TRUE(waitUntil([&] { return !warning->isVisible(); }));
}

TEST_F(RawImportTest, AnyFileCanBeImported) {
    dialogs_.answers.push_back(
        qpath(folder_.write("scan.xyzzy", raw(ballSamples<std::uint8_t>({20, 18, 16}, 250.0), false))));
    trigger("file.importRaw");
    auto* shown = dialog("rawImportDialog");
    ASSERT_TRUE(waitForPreview(shown));
    QTest::keyClick(shown, Qt::Key_Escape);
    EXPECT_TRUE(isGone("rawImportDialog"));
    EXPECT_EQ(session_->dataset(), nullptr);
}

TEST_F(OpenFlowTest, WhatABuildLeftBehindIsNoVolume) {
    drop(folder_.write("scan.isx.resume", std::string(4096, 'x')));
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    const QString said = window_->messageBar().text();
    EXPECT_TRUE(said.contains(QStringLiteral("is a part of the index 'scan.isx', not a volume"))) << said.toStdString();
    EXPECT_EQ(session_->dataset(), nullptr);
    keepPicture(*window_, "open_leftover");
}

} // namespace
} // namespace isoslider::test
