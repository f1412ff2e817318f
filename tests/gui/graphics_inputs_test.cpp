// B105 and B106: a graphics context that goes, and a graphics card without memory.
#include <string>
#include <string_view>

#include <QDockWidget>
#include <QElapsedTimer>
#include <QLabel>
#include <QLayout>
#include <QMainWindow>
#include <QOpenGLContext>
#include <QSplitter>
#include <QTest>

#include "core/extract/live/brick_picture.h"
#include "core/mesh/mesh_checks.h"
#include "tests/gui/faulty_driver.h"
#include "tests/gui/image_likeness.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

// Of arrays: positions, normals, indices, changed, tints; of bricks: codes, indices, inner, places, changed, tints, a
// page of points; of drafts: vertices, indices; box.
constexpr std::size_t kBuffers = 15;

/// The surface, and nothing of the grey background, is warm: clearly more red than blue.
std::size_t surfacePixels(const QImage& image) {
    std::size_t count = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            count += qRed(image.pixel(x, y)) > qBlue(image.pixel(x, y)) + 12 ? 1 : 0;
    return count;
}

/// With pictures as textures, as with a card, and as images, as with software OpenGL.
class GraphicsInputs : public WindowTest, public ::testing::WithParamInterface<const char*> {
protected:
    void SetUp() override {
        qputenv("ISOSLIDER_PICTURES", GetParam());
        makeWindow();
        viewport_ = window_->viewportHost().viewport();
        if (viewport_ == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        viewport_->setFixedSize(500, 400);
        viewport_->setDriver(driver_);
        openBall(40);
        request(-12.0);
    }
    void TearDown() override { qunsetenv("ISOSLIDER_PICTURES"); }
    bool hasTextures() const { return std::string_view(GetParam()) == "textures"; }

    void request(double isovalue) {
        session_->isovalue().request(isovalue);
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_TRUE(waitUntilPainted());
    }
    bool waitUntilPainted() {
        const auto before = viewport_->paintedFrames();
        viewport_->changeCamera([](model::Camera&) {}); // another picture, if of the same
        viewport_->showAgain();
        return waitUntil([&] { return viewport_->paintedFrames() > before; });
    }
    QImage grab() { return viewport_->grabFramebuffer().convertToFormat(QImage::Format_RGB32); }
    void expectSamePicture(const QImage& before) {
        const QImage after = grab();
        EXPECT_GE(structuralSimilarity(before, after), 0.99);
        EXPECT_GT(surfacePixels(after), 10'000u);
        EXPECT_EQ(driver_->buffers(), kBuffers) << "what another context held was freed, and nothing else";
    }

    std::shared_ptr<FaultyDriver> driver_ = std::make_shared<FaultyDriver>();
    widgets::ViewportWidget* viewport_ = nullptr;
};

TEST_P(GraphicsInputs, TheLikenessOfPicturesTellsThemApart) {
    const QImage large = grab();
    EXPECT_EQ(structuralSimilarity(large, large), 1.0);
    request(-11.0);
    EXPECT_LT(structuralSimilarity(large, grab()), 0.99);
}

TEST_P(GraphicsInputs, B105_TheViewIsMovedBetweenWindowsAndDocks) {
    const QImage before = grab();
    QMainWindow other;
    other.resize(900, 700);
    auto* dock = new QDockWidget(&other);
    other.addDockWidget(Qt::LeftDockWidgetArea, dock);
    auto* home = qobject_cast<QSplitter*>(window_->viewportHost().parentWidget());
    ASSERT_NE(home, nullptr);
    const auto contextOf = [this] { return QPointer<QOpenGLContext>(viewport_->context()); };
    int contexts = 0;
    for (int move = 0; move < 20; ++move) {
        const auto context = contextOf();
        if (move % 4 == 0) {
            dock->setWidget(&window_->viewportHost());
            other.show();
        } else if (move % 4 == 3) {
            home->insertWidget(0, &window_->viewportHost());
            other.hide();
        } else {
            dock->setFloating(move % 4 == 1);
        }
        window_->viewportHost().show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(viewport_->window()));
        QElapsedTimer clock;
        clock.start();
        ASSERT_TRUE(waitUntilPainted());
        EXPECT_LE(clock.elapsed(), 2000);
        contexts += context == contextOf() ? 0 : 1;
        expectSamePicture(before);
    }
    if (hasTextures()) // they share with the window's
        EXPECT_GE(contexts, 10);
    else
        EXPECT_EQ(contexts, 0);
}

TEST_P(GraphicsInputs, B105_TheCardIsResetAgainAndAgain) {
    const QImage before = grab();
    for (int reset = 0; reset < 20; ++reset) {
        const QPointer<QOpenGLContext> context(viewport_->context());
        driver_->lostContexts = 1;
        QElapsedTimer clock;
        clock.start();
        ASSERT_TRUE(waitUntilPainted());
        EXPECT_LE(clock.elapsed(), 2000);
        EXPECT_TRUE(context.isNull()) << "a new context";
        expectSamePicture(before);
    }
    // It keeps what it is shown from then on.
    request(-8.0);
    EXPECT_LT(surfacePixels(grab()), surfacePixels(before));
    EXPECT_FALSE(window_->messageBar().isVisible());
}

TEST_P(GraphicsInputs, B105_ACardThatStaysAwayIsWaitedFor) {
    const QImage before = grab();
    driver_->lostContexts = 7;
    viewport_->changeCamera([](model::Camera&) {});
    viewport_->showAgain();
    ASSERT_TRUE(waitUntil([&] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("was reset")));
    session_->isovalue().request(-5.0);
    EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -5.0; })) << "the panels work";
    session_->isovalue().request(-12.0);
    ASSERT_TRUE(waitUntilSettled());
    ASSERT_TRUE(waitUntilPainted());
    expectSamePicture(before);
}

TEST_P(GraphicsInputs, B105_AContextThatGoesUnnoticedLeavesNoNamesBehind) {
    if (!hasTextures())
        GTEST_SKIP() << "the context is in nobody else's hands";
    const QImage before = grab();
    for (int loss = 0; loss < 3; ++loss) {
        QObject::disconnect(viewport_->context(), nullptr, &viewport_->view(), nullptr);
        driver_->lostContexts = 1;
        ASSERT_TRUE(waitUntilPainted());
        EXPECT_GE(structuralSimilarity(before, grab()), 0.99);
    }
}

TEST_P(GraphicsInputs, B105_TheScreenChanges) {
    const QImage before = grab();
    for (int change = 0; change < 5; ++change) {
        QEvent event(QEvent::ScreenChangeInternal);
        QApplication::sendEvent(&viewport_->view(), &event);
        window_->hide();
        window_->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(window_.get()));
        ASSERT_TRUE(waitUntilPainted());
        expectSamePicture(before);
    }
}

TEST_P(GraphicsInputs, B106_EachAllocationFailsOnce) {
    trigger("view.reset"); // the whole box, whatever the first surface
    const auto pixels = surfacePixels(grab());
    for (int call = 1; call <= 5; ++call) {
        openBall(40); // what is found out of the card's memory is for one volume
        trigger("view.reset");
        request(-12.0);
        const int refusals = driver_->refusals();
        driver_->refusedCall = driver_->allocations() + call;
        viewport_->setDriver(driver_); // new buffers: codes, indices, places, points, box
        request(-11.0 - 0.1 * call);
        request(-12.0);
        EXPECT_EQ(driver_->refusals(), refusals + 2) << call;
        // Whole, or a coarser one that is made after the refusal was noticed.
        ASSERT_TRUE(waitUntil([&] { return surfacePixels(grab()) > 0; })) << call;
        EXPECT_NEAR(static_cast<double>(surfacePixels(grab())) / static_cast<double>(pixels), 1.0, 0.06) << call;
    }
}

TEST_P(GraphicsInputs, B106_ASurfaceOfThreeTimesTheMemoryIsShownCoarser) {
    // How large a picture is depends on the way to it: here, from a small surface over a larger one.
    for (const double isovalue : {-2.0, -14.0, -12.0})
        request(isovalue);
    const auto whole = session_->frame();
    const auto pixels = surfacePixels(grab());
    request(-2.0);
    extract::SurfaceFrame arrays = *whole; // which take less than bricks where these are as empty as here
    extract::expandPicture(arrays);
    driver_->memoryBytes = extract::pictureBytes(arrays) / 3;
    viewport_->setDriver(driver_); // what it has already would do
    session_->isovalue().request(-12.0);
    auto* label = child<QLabel>("previewLabel");
    ASSERT_TRUE(waitUntil([&] { return label->isVisible() && session_->isSettled(); }));
    ASSERT_TRUE(waitUntilPainted());

    EXPECT_GT(driver_->refusals(), 0);
    const auto coarse = session_->frame();
    EXPECT_GT(coarse->mergedCells, 1);
    EXPECT_EQ(coarse->stats.triangles, whole->stats.triangles);
    EXPECT_NEAR(static_cast<double>(surfacePixels(grab())) / static_cast<double>(pixels), 1.0, 0.05);
    const auto banner = window_->messageBar().text();
    EXPECT_TRUE(window_->messageBar().isVisible());
    EXPECT_TRUE(banner.contains(QStringLiteral("no memory for this surface")));
    EXPECT_TRUE(banner.contains(QStringLiteral("blocks of %1 cells").arg(coarse->mergedCells))) << banner.toStdString();
    EXPECT_TRUE(label->text().contains(QStringLiteral("blocks of %1 cells").arg(coarse->mergedCells)));
    keepPicture(*window_, "no-graphics-memory");

    // What is exported is the whole surface.
    dialogs_.answers.push_back(QString::fromStdString((folder_ / "whole.ply").string()));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntilSettled());
    const auto report = mesh::checkMeshFile(folder_ / "whole.ply");
    ASSERT_TRUE(report.isOk());
    EXPECT_EQ(report.value().triangles, whole->stats.triangles);

    // One that fits is drawn whole.
    const int refusals = driver_->refusals();
    request(-2.0);
    EXPECT_EQ(session_->frame()->mergedCells, 1);
    EXPECT_FALSE(label->isVisible());
    EXPECT_GT(surfacePixels(grab()), 0u);
    EXPECT_EQ(driver_->refusals(), refusals);
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("whole again")));
}

TEST_P(GraphicsInputs, B106_NoMemoryForAnySurface) {
    driver_->memoryBytes = 0;
    viewport_->setDriver(driver_);
    session_->isovalue().request(-11.0);
    ASSERT_TRUE(waitUntil([&] { return window_->messageBar().text().contains(QStringLiteral("any surface")); }));
    EXPECT_EQ(surfacePixels(grab()), 0u);
    session_->isovalue().request(-10.0);
    ASSERT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -10.0; })) << "the panels work";
    driver_->memoryBytes = std::size_t{1} << 30;
    request(-2.0);
    EXPECT_GT(surfacePixels(grab()), 0u);
}

INSTANTIATE_TEST_SUITE_P(Ways, GraphicsInputs, ::testing::Values("textures", "images"),
                         [](const auto& way) { return std::string(way.param); });

} // namespace
} // namespace isoslider::test
