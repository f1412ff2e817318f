// What the window writes, it writes on other threads: its own never waits for a disk.
#include <QAction>
#include <QImage>
#include <QLabel>
#include <QPainter>
#include <QTest>
#include <QThread>
#include <QToolButton>

#include "core/volume_io/volume_reader.h"
#include "tests/gui/sync_watch.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/session/saved_session.h"
#include "ui/render/gl_support.h"
#include "ui/widgets/viewport/picture_file.h"
#include "ui/widgets/viewport/picture_halo.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

class WritingTest : public WindowTest {
protected:
    void SetUp() override {
        openBall();
        QTest::qWait(20); // the settings
        ownBefore_ = syncsOfThisThread();
        allBefore_ = syncsOfAllThreads();
    }
    void expectOthersWaited() {
        EXPECT_EQ(syncsOfThisThread(), ownBefore_);
        EXPECT_GT(syncsOfAllThreads(), allBefore_);
    }

    int ownBefore_ = 0;
    int allBefore_ = 0;
};

TEST_F(WritingTest, TheWatchSeesBothThreads) {
    ASSERT_TRUE(writeWholeFile(folder_ / "own", "x").isOk());
    EXPECT_GT(syncsOfThisThread(), ownBefore_);
}

TEST_F(WritingTest, ASessionIsSavedByAnotherThread) {
    dialogs_.answers.push_back(qpath(folder_ / "ball.isosession"));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("Session saved")));
    EXPECT_TRUE(model::readSession(folder_ / "ball.isosession").isOk());
    expectOthersWaited();
}

TEST_F(WritingTest, ASessionIsKeptByAnotherThread) {
    window_->sessionKeeper().keepIn(folder_ / "sessions", std::chrono::milliseconds(1));
    ASSERT_TRUE(waitUntil([this] {
        for (const auto& entry : fs::directory_iterator(folder_ / "sessions"))
            if (model::isSessionFile(entry.path()))
                return true;
        return false;
    }));
    expectOthersWaited();
}

TEST_F(WritingTest, ASessionIsWrittenThoughTheWindowCloses) {
    dialogs_.answers.push_back(qpath(folder_ / "ball.isosession"));
    trigger("file.saveSession");
    window_.reset();
    EXPECT_TRUE(model::readSession(folder_ / "ball.isosession").isOk());
}

TEST_F(WritingTest, SettingsAreKeptByAnotherThread) {
    window_->actions().action("view.box")->toggle();
    window_->close(); // keeps its layout
    QTest::qWait(50);
    const bool shown = window_->actions().action("view.box")->isChecked();
    EXPECT_EQ(settings_->boolean("view/showsBox"), shown);
    window_.reset();
    settings_.reset();
    expectOthersWaited();
    const widgets::SettingsStore again(qpath(folder_ / "settings.ini"));
    EXPECT_EQ(again.boolean("view/showsBox"), shown);
    EXPECT_FALSE(again.bytes("window/state").isEmpty());
    EXPECT_EQ(again.list("files/recent").size(), 1);
}

TEST_F(WritingTest, APictureIsWrittenByAnotherThread) {
    if (window_->viewportHost().viewport() == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    dialogs_.answers.push_back(qpath(folder_ / "view.png"));
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("Image saved")));
    EXPECT_FALSE(QImage(qpath(folder_ / "view.png")).isNull());
    expectOthersWaited();
}

TEST_F(WritingTest, APictureHasTheSizeAndBackgroundThatWereChosen) {
    if (window_->viewportHost().viewport() == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    const auto saved = [this](const char* name, std::optional<widgets::PictureChoice> choice) {
        window_->messageBar().hide();
        dialogs_.picture = choice;
        dialogs_.answers.push_back(qpath(folder_ / name));
        trigger("file.saveImage");
        EXPECT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
        EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("Image saved")))
            << window_->messageBar().text().toStdString();
        window_->messageBar().hide();
        QApplication::processEvents();
        return QImage(qpath(folder_ / name));
    };
    trigger("colour.x");
    trigger("view.ticks");
    ASSERT_TRUE(waitUntil([this] { return child<QWidget>("colourBar")->isVisible(); }));
    const QImage plain = saved("plain.png", std::nullopt);
    const QSize view = dialogs_.viewPixels;
    EXPECT_EQ(plain.size(), view);
    EXPECT_FALSE(plain.hasAlphaChannel());
    const QImage twice = saved("twice.png", widgets::PictureChoice{2, 1920, false});
    EXPECT_EQ(twice.size(), 2 * dialogs_.viewPixels);
    const QImage transparent = saved("transparent.png", widgets::PictureChoice{0, 700, true});
    EXPECT_EQ(transparent.width(), 700);
    EXPECT_NEAR(transparent.height(), 700.0 * dialogs_.viewPixels.height() / dialogs_.viewPixels.width(), 1.0);
    ASSERT_TRUE(transparent.hasAlphaChannel());
    const QRect middle(transparent.rect().center() - QPoint(3, 3), QSize(6, 6));
    EXPECT_EQ(qAlpha(transparent.pixel(middle.center())), 255) << "the ball is opaque";
    EXPECT_EQ(qAlpha(transparent.pixel(transparent.width() / 4, 1)), 0);
    QLabel page;
    page.setStyleSheet(QStringLiteral("background: white"));
    page.setPixmap(QPixmap::fromImage(transparent));
    keepPicture(page, "transparent_on_white");
    saved("again.png", std::nullopt);
    EXPECT_EQ(dialogs_.lastPicture, (widgets::PictureChoice{0, 700, true})) << "as it was last";
    dialogs_.answers.push_back(qpath(folder_ / "view.jpg"));
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("end its name in .png")));
}

TEST(PictureHalo, SurroundsWhatIsDrawn) {
    QImage drawn(40, 40, QImage::Format_ARGB32_Premultiplied);
    drawn.fill(Qt::transparent);
    QPainter(&drawn).fillRect(15, 15, 10, 10, Qt::white);
    const QImage halo = widgets::withHalo(drawn, QColor(0, 0, 0, 150), 3.0);
    EXPECT_EQ(halo.pixel(20, 20), qRgb(255, 255, 255)) << "what is drawn stays as it is";
    EXPECT_GT(qAlpha(halo.pixel(13, 20)), 120);
    EXPECT_LT(qRed(halo.pixel(13, 20)), 20);
    EXPECT_EQ(qAlpha(halo.pixel(10, 20)), 0) << "beyond its width";
}

TEST_F(WritingTest, APictureThatCannotBeWrittenIsTold) {
    if (window_->viewportHost().viewport() == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    dialogs_.answers.push_back(qpath(folder_ / "no" / "view.png"));
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("could not be saved")));
}

/// A card that takes as long as a test wants, five seconds at most.
class HeldDriver final : public render::GlDriver {
public:
    std::atomic<bool> holds = false;
    std::atomic<bool> gaveUp = false; ///< nobody released it

    bool isLost(QOpenGLContext& context) override {
        for (int i = 0; holds && i < 1000; ++i)
            QThread::msleep(5);
        gaveUp = gaveUp || holds;
        return GlDriver::isLost(context);
    }
};

TEST_F(WritingTest, TheWindowGoesOnWhileAPictureIsDrawn) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr || !render::isOpenGlSoftware())
        GTEST_SKIP() << "of a card that draws textures nobody asks whether it is lost";
    const auto driver = std::make_shared<HeldDriver>();
    viewport->setDriver(driver);
    const auto painted = viewport->paintedFrames();
    ASSERT_TRUE(waitUntil([&] { return viewport->paintedFrames() > painted; }));
    auto* status = child<QWidget>("jobStatus");
    dialogs_.answers = {qpath(folder_ / "first.png"), qpath(folder_ / "view.png")};
    driver->holds = true;
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([&] { return status->isVisible(); }, std::chrono::seconds(4)));
    EXPECT_FALSE(driver->gaveUp) << "the window has waited for the picture";
    EXPECT_EQ(status->findChild<QToolButton*>()->text(), QStringLiteral("Save first.png"));
    keepPicture(*window_, "save_image_job");
    auto* cancel = child<QToolButton>("cancelShownJob");
    QTest::mouseClick(cancel, Qt::LeftButton);
    EXPECT_TRUE(waitUntil([&] { return !status->isVisible(); }, std::chrono::seconds(3)));
    EXPECT_FALSE(driver->gaveUp);
    EXPECT_FALSE(window_->messageBar().isVisible()) << "the user knows";
    driver->holds = false;
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("Image saved")));
    EXPECT_FALSE(QImage(qpath(folder_ / "view.png")).isNull());
    EXPECT_FALSE(fs::exists(folder_ / "first.png"));
}

TEST_F(WritingTest, APictureIsWrittenThoughTheWindowCloses) {
    if (window_->viewportHost().viewport() == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    dialogs_.answers.push_back(qpath(folder_ / "view.png"));
    trigger("file.saveImage");
    window_.reset();
    session_.reset();
    EXPECT_FALSE(QImage(qpath(folder_ / "view.png")).isNull());
}

TEST_F(WritingTest, NoOutputReplacesAFileOfTheOpenVolume) {
    const auto volume = folder_ / "ball.mha";
    const auto before = fs::file_size(volume);
    const auto link = folder_ / "link.ply";
    fs::create_symlink(volume, link);
    const auto index = folder_ / "index.stl";
    fs::create_symlink(session_->dataset()->indexPath, index);
    for (const auto& output : {link, index}) {
        window_->messageBar().hide();
        dialogs_.answers.push_back(qpath(output));
        trigger("mesh.export");
        ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); })) << output;
        const QString said = window_->messageBar().text();
        EXPECT_TRUE(said.startsWith(QStringLiteral("The mesh was not exported"))) << said.toStdString();
        EXPECT_TRUE(said.contains(QStringLiteral("is a file that the open volume is read from; choose another name")))
            << said.toStdString();
    }
    keepPicture(*window_, "export_onto_volume");
    EXPECT_EQ(fs::file_size(volume), before);
    EXPECT_TRUE(io::readVolume(volume).isOk());
    if (window_->viewportHost().viewport() == nullptr)
        return;
    fs::create_symlink(volume, folder_ / "link.png");
    window_->messageBar().hide();
    dialogs_.answers.push_back(qpath(folder_ / "link.png"));
    trigger("file.saveImage");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("the open volume is read from")));
    EXPECT_TRUE(io::readVolume(volume).isOk());
}

// Of a header with a data file beside it both are read.
TEST_F(WritingTest, NoMeshReplacesTheDataFileBesideAHeader) {
    const auto header = folder_.write("parts.mhd", "ObjectType = Image\nNDims = 3\nDimSize = 8 8 8\n"
                                                   "ElementType = MET_UCHAR\nElementDataFile = parts.ply\n");
    std::string samples(8 * 8 * 8, '\0');
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = static_cast<char>(i % 8);
    folder_.write("parts.ply", samples);
    window_->openFile(qpath(header));
    ASSERT_TRUE(waitUntil([this] { return session_->isSettled() && session_->dataset()->name == "parts.mhd"; }));
    window_->messageBar().hide();
    dialogs_.answers.push_back(qpath(folder_ / "parts.ply"));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("the open volume is read from")))
        << window_->messageBar().text().toStdString();
    EXPECT_EQ(fs::file_size(folder_ / "parts.ply"), samples.size());
}

TEST(PictureFile, IsWrittenInTheFormatOfItsSuffix) {
    const TemporaryFolder folder;
    QImage picture(40, 30, QImage::Format_RGB32);
    picture.fill(Qt::red);
    for (const char* name : {"a.png", "a.PNG", "a.jpg", "a.bmp"}) {
        const auto status = widgets::writePicture(picture, folder / name);
        ASSERT_TRUE(status.isOk()) << name;
        EXPECT_EQ(QImage(qpath(folder / name)).size(), picture.size()) << name;
    }
    for (const char* name : {"a", "a.xyz", "a."})
        EXPECT_EQ(widgets::writePicture(picture, folder / name).error().code, ErrorCode::InvalidArgument) << name;
    EXPECT_EQ(widgets::writePicture(picture, folder / "no" / "a.png").error().code, ErrorCode::NotFound);
}

} // namespace
} // namespace isoslider::test
