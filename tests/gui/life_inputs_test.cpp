// B108 to B110 and B112: windows that are closed at work, bad files over a good one, sessions that are none,
// and monitors that are gone.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <random>

#include <QElapsedTimer>
#include <QGuiApplication>
#include <QScreen>
#include <QTest>
#include <QToolButton>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

class WindowLife : public WindowTest {
protected:
    static std::size_t threadCount() {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator("/proc/self/task"), {}));
    }
    fs::path writeVolume(const char* name, int side, const char* type, const std::string& samples) const {
        const std::string size = std::to_string(side);
        return folder_.write(
            name, "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = " +
                      size + " " + size + " " + size + "\nElementSpacing = 1 1 1\nElementType = " + type +
                      "\nElementDataFile = LOCAL\n" + samples);
    }
    /// u8 noise: a surface of a million triangles.
    fs::path writeNoise(int side) const {
        std::string samples(
            static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * static_cast<std::size_t>(side), '\0');
        std::minstd_rand random(5);
        for (char& sample : samples)
            sample = static_cast<char>(random() >> 8);
        return writeVolume("noise.mha", side, "MET_UCHAR", samples);
    }
    std::vector<std::string> partials() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
            if (entry.path().extension() == ".partial")
                names.push_back(entry.path().filename().string());
        return names;
    }
    /// Has `begin` start some work, closes the window when it `isAtWork`, and does that again: fewer threads
    /// come than one each time. (Workers that all jobs share come and go.)
    void expectClosesSoon(const std::function<void()>& begin, const std::function<bool()>& isAtWork) {
        std::size_t threads = 0;
        constexpr std::size_t kRounds = 4;
        for (std::size_t round = 0; round < kRounds; ++round) {
            SCOPED_TRACE(round);
            fs::remove_all(folder_ / "indexes");
            makeWindow();
            begin();
            ASSERT_TRUE(waitUntil(isAtWork));
            QElapsedTimer clock;
            clock.start();
            window_->close();
            window_.reset();
            session_.reset();
            EXPECT_LE(clock.elapsed(), 5000); // one second where nothing else runs
            EXPECT_TRUE(partials().empty()) << partials().front();
            threads = round == 0 ? threadCount() : threads;
        }
        EXPECT_TRUE(waitUntil([&] { return threadCount() < threads + kRounds - 1; }, std::chrono::seconds(30)))
            << threadCount() << " threads, after the first time " << threads;
    }
};

TEST_F(WindowLife, B108_ClosedWhileAVolumeIsRead) {
    const auto large = writeVolume("large.mha", 700, "MET_UCHAR", "");
    fs::resize_file(large, fs::file_size(large) + std::uint64_t{700} * 700 * 700);
    expectClosesSoon([&] { window_->openFile(qpath(large)); }, [this] { return session_->isLoading(); });
}

TEST_F(WindowLife, B108_ClosedWhileAnIndexIsBuilt) {
    const auto ball = writeBall(folder_, "ball.mha", 128); // much to index, little to draw
    expectClosesSoon(
        [&] {
            builder_->kind = index::IndexKind::Edges; // takes long
            window_->openFile(qpath(ball));
        },
        [this] { return session_->dataset() != nullptr && session_->indexState() == model::IndexState::Building; });
    EXPECT_TRUE(!fs::exists(folder_ / "indexes") || fs::is_empty(folder_ / "indexes")) << "half an index";
}

TEST_F(WindowLife, B108_ClosedWhileAMeshIsExported) {
    const auto noise = writeNoise(80); // so large that it is not done before the window closes
    const auto mesh = folder_ / "noise.ply";
    expectClosesSoon(
        [&] {
            fs::remove(mesh);
            window_->openFile(qpath(noise));
            ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }, std::chrono::seconds(30)));
            dialogs_.answers.push_back(qpath(mesh));
            trigger("mesh.export");
        },
        [] { return true; });
    EXPECT_FALSE(fs::exists(mesh)) << "cancelled";
}

TEST_F(WindowLife, B109_NoBadFileTakesThePlaceOfTheGoodOne) {
    openBall();
    const auto frame = session_->frame();
    const auto dataset = session_->dataset()->name;
    const std::string index = readText(session_->dataset()->indexPath);
    std::string flipped = index, later = index;
    flipped[40] = static_cast<char>(flipped[40] ^ 1);
    later[12] = 9;
    fs::create_directory(folder_ / "empty folder");
    ASSERT_EQ(::mkfifo((folder_ / "pipe.mha").c_str(), 0600), 0);
    writeVolume("cut.mha", 24, "MET_FLOAT", std::string(1000, '\0'));
    writeVolume("nan.mha", 4, "MET_FLOAT", std::string(4 * 64, '\xff'));
    folder_.write("text.nrrd", "Dear reader,\n");
    folder_.write("zero.nii", "");
    folder_.write("flipped.isx", flipped);
    folder_.write("later.isx", later);
    folder_.write("cut.isx", index.substr(0, index.size() / 2));
    folder_.write("text.isx", "Dear reader,\n");
    folder_.write("image.tif", "II*");
    folder_.write("mesh.vti", "<VTKFile");
    double isovalue = -5.0;
    for (const char* name : {"cut.mha", "nan.mha", "text.nrrd", "zero.nii", "flipped.isx", "later.isx", "cut.isx",
                             "text.isx", "image.tif", "mesh.vti", "pipe.mha", "empty folder", "none.mha"}) {
        SCOPED_TRACE(name);
        window_->messageBar().hide();
        window_->openFile(qpath(folder_ / name));
        ASSERT_TRUE(waitUntil([&] { return window_->messageBar().isVisible(); }));
        EXPECT_TRUE(window_->messageBar().text().contains(QLatin1String(name)))
            << window_->messageBar().text().toStdString();
        ASSERT_NE(session_->dataset(), nullptr);
        EXPECT_EQ(session_->dataset()->name, dataset);
        EXPECT_FALSE(session_->isLoading());
        isovalue += 0.125;
        session_->isovalue().request(isovalue);
        EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == isovalue; }));
    }
    EXPECT_NE(session_->frame(), nullptr);
    session_->isovalue().request(frame->isovalue);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->frame()->stats.triangles, frame->stats.triangles);
}

TEST_F(WindowLife, B110_SessionsOfAGigabyteOrOfAnotherVersion) {
    const auto large = folder_.write("large.isosession", "{");
    fs::resize_file(large, std::uintmax_t{1} << 30);
    QElapsedTimer clock;
    clock.start();
    window_->openFile(qpath(large));
    EXPECT_LE(clock.elapsed(), 1000);
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("larger than a session")))
        << window_->messageBar().text().toStdString();
    const auto ball = writeBall(folder_, "ball.mha", 24).string();
    for (const auto& [version, isovalue] : {std::pair("7", -6.5), std::pair("0", -6.0), std::pair("-1", -5.5)}) {
        SCOPED_TRACE(version);
        trigger(session_->dataset() != nullptr ? "file.close" : "view.resetLayout");
        window_->openFile(qpath(folder_.write("other.isosession", std::string(R"({"isosliderSession": )") + version +
                                                                      R"(, "isovalue": )" + std::to_string(isovalue) +
                                                                      R"(, "volume": {"path": ")" + ball + "\"}}")));
        EXPECT_TRUE(window_->messageBar().isVisible());
        if (std::string_view(version) != "7") // no version that there was
            continue;
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
        EXPECT_EQ(session_->isovalue().requested(), isovalue);
        EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("later version")))
            << window_->messageBar().text().toStdString();
    }
}

TEST_F(WindowLife, B112_AWindowLeftOnAMonitorThatIsGoneComesBack) {
    const QRect screen = QGuiApplication::primaryScreen()->availableGeometry();
    for (const QPoint place : {QPoint(20'000, 9'000), QPoint(-20'000, -9'000), QPoint(screen.right() + 50, 100)}) {
        window_->showNormal();
        window_->resize(800, 600);
        window_->move(place);
        QTest::qWait(20);
        window_->close();
        makeWindow();
        window_->restoreLayout();
        QTest::qWait(20);
        const QRect shown = window_->frameGeometry() & screen;
        EXPECT_GE(shown.width(), 300) << place.x();
        EXPECT_GE(shown.height(), 200) << place.x();
    }
}

} // namespace
} // namespace isoslider::test
