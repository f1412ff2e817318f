// Headerless files: which arrangements suggest themselves, and what the import dialog makes of them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/opening/raw_guess.h"
#include "ui/model/opening/raw_import_model.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;
namespace fs = std::filesystem;

/// Bytes of three soft balls in noise, `scale` times 0 to 1 and `offset` more.
struct RawFile {
    GridDims dims{0, 0, 0};
    ScalarType type = ScalarType::U8;
    bool isBigEndian = false;
    std::uint64_t skipBytes = 0;
    double scale = 200.0;
    double offset = 0.0;
};

std::string bytesOf(const RawFile& file, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-0.015, 0.015);
    std::string bytes;
    for (std::uint64_t i = 0; i < file.skipBytes; ++i)
        bytes.push_back(static_cast<char>(random() & 0xff));
    const auto at = [&](std::int64_t i, int axis) {
        return static_cast<double>(i) / static_cast<double>(file.dims[static_cast<std::size_t>(axis)]);
    };
    constexpr double kBalls[3][3] = {{0.4, 0.5, 0.35}, {0.65, 0.3, 0.6}, {0.3, 0.75, 0.7}};
    for (std::int64_t z = 0; z < file.dims[2]; ++z)
        for (std::int64_t y = 0; y < file.dims[1]; ++y)
            for (std::int64_t x = 0; x < file.dims[0]; ++x) {
                double value = 0.1;
                for (const auto& ball : kBalls) {
                    const double r = std::hypot(at(x, 0) - ball[0], at(y, 1) - ball[1], at(z, 2) - ball[2]);
                    value += 0.8 / (1.0 + std::exp((r - 0.2) * 30.0));
                }
                value = file.offset + file.scale * std::clamp(value + noise(random), 0.0, 1.0);
                visitScalarType(file.type, [&](auto sample) {
                    sample = static_cast<decltype(sample)>(value);
                    auto raw = std::bit_cast<std::array<char, sizeof sample>>(sample);
                    if (file.isBigEndian)
                        std::reverse(raw.begin(), raw.end());
                    bytes.append(raw.data(), raw.size());
                });
            }
    return bytes;
}

class RawRankingTest : public ::testing::Test {
protected:
    RawGuess best(const RawFile& file, const char* name = "scan.raw") {
        const auto guesses = rankRawLayouts(folder_.write(name, bytesOf(file)));
        EXPECT_THAT(guesses, IsOk());
        return guesses.isOk() && !guesses.value().empty() ? guesses.value().front() : RawGuess();
    }
    void expectFound(const RawFile& file, const char* name = "scan.raw") {
        const auto found = best(file, name).layout;
        EXPECT_EQ(found.dims, file.dims);
        EXPECT_EQ(scalarTypeName(found.type), scalarTypeName(file.type));
        EXPECT_EQ(found.isBigEndian, file.isBigEndian);
        EXPECT_EQ(found.skipBytes, file.skipBytes);
    }
    test::TemporaryFolder folder_;
};

TEST_F(RawRankingTest, FindsBytes) { expectFound({{40, 30, 24}}); }
TEST_F(RawRankingTest, FindsDimsThatAreNoCube) { expectFound({{60, 36, 17}}); }
TEST_F(RawRankingTest, FindsShorts) { expectFound({{36, 40, 20}, ScalarType::U16, false, 0, 4000.0}); }
TEST_F(RawRankingTest, FindsShortsTheOtherWayRound) { expectFound({{36, 40, 20}, ScalarType::U16, true, 0, 4000.0}); }
TEST_F(RawRankingTest, FindsSignedShorts) { expectFound({{32, 48, 20}, ScalarType::I16, false, 0, 3000.0, -1000.0}); }
TEST_F(RawRankingTest, FindsIntegers) { expectFound({{32, 24, 20}, ScalarType::I32, false, 0, 100000.0, -5000.0}); }
TEST_F(RawRankingTest, FindsFloats) { expectFound({{40, 30, 24}, ScalarType::F32, false, 0, 1.0}); }
TEST_F(RawRankingTest, FindsFloatsTheOtherWayRound) { expectFound({{40, 30, 24}, ScalarType::F32, true, 0, 50.0}); }
TEST_F(RawRankingTest, FindsDoubles) { expectFound({{24, 20, 28}, ScalarType::F64, false, 0, 1.0, -0.5}); }
TEST_F(RawRankingTest, FindsDoublesTheOtherWayRound) { expectFound({{24, 20, 28}, ScalarType::F64, true, 0, 1e-6}); }
TEST_F(RawRankingTest, SkipsTheHeaderOfACube) { expectFound({{32, 32, 32}, ScalarType::U16, false, 352, 4000.0}); }
TEST_F(RawRankingTest, SkipsWhatTheNamedDimsLeave) {
    expectFound({{30, 22, 26}, ScalarType::U8, false, 77}, "scan_30x22x26.raw");
}

TEST_F(RawRankingTest, BelievesTheNameUnlessTheBytesAreFarBetter) {
    const RawFile noise{{24, 24, 24}, ScalarType::U8, false, 0, 0.0};
    const auto guess = best(noise, "scan_12x24x48.raw");
    EXPECT_EQ(guess.layout.dims, (GridDims{12, 24, 48})) << "constant: the bytes say nothing";
    EXPECT_TRUE(guess.isNamed);
}

TEST_F(RawRankingTest, GivesEveryGuessOnceAndOnlyWhatTakesAllBytes) {
    const auto path = folder_.write("scan.raw", bytesOf({{40, 30, 24}}));
    const auto guesses = rankRawLayouts(path);
    ASSERT_THAT(guesses, IsOk());
    EXPECT_GT(guesses.value().size(), 3u);
    EXPECT_LE(guesses.value().size(), kMostRawGuesses);
    for (std::size_t i = 0; i < guesses.value().size(); ++i) {
        const auto& guess = guesses.value()[i];
        EXPECT_EQ(guess.layout.skipBytes + static_cast<std::uint64_t>(pointCount(guess.layout.dims)) *
                                               scalarTypeSizeBytes(guess.layout.type),
                  fs::file_size(path));
        EXPECT_TRUE(i == 0 || guesses.value()[i - 1].cost <= guess.cost);
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_FALSE(guesses.value()[k].layout == guess.layout);
    }
    EXPECT_GT(guesses.value()[0].smoothness, 0.7);
}

TEST_F(RawRankingTest, OfTinyAndStrangeFilesGivesWhatThereIs) {
    for (const char* bytes : {"", "a", "seven b"})
        EXPECT_THAT(rankRawLayouts(folder_.write("tiny.raw", bytes)), IsOk()) << bytes;
    EXPECT_THAT(rankRawLayouts(folder_ / "nowhere.raw"), HasError(ErrorCode::NotFound));
    EXPECT_THAT(rankRawLayouts(folder_.path()), HasError(ErrorCode::InvalidArgument));
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(rankRawLayouts(folder_.write("a.raw", bytesOf({{16, 16, 16}})), job), HasError(ErrorCode::Cancelled));
}

TEST(RawNames, SayTheByteOrderInAWordOfItsOwn) {
    EXPECT_EQ(layoutInName("head_64x64x64_u16_be.raw").isBigEndian, true);
    EXPECT_EQ(layoutInName("head-LE.raw").isBigEndian, false);
    EXPECT_FALSE(layoutInName("beetle.raw").isBigEndian);
    EXPECT_EQ(layoutInName("head_64x32x16_u16.raw").dims, (GridDims{64, 32, 16}));
}

TEST_F(RawRankingTest, SeesBytesTakenInTheWrongOrder) {
    const RawFile file{{36, 40, 20}, ScalarType::U16, true, 0, 4000.0};
    const auto path = folder_.write("scan.raw", bytesOf(file));
    io::RawLayout layout;
    layout.dims = file.dims;
    layout.type = file.type;
    const auto wrong = checkByteOrder(path, layout);
    ASSERT_THAT(wrong, IsOk());
    EXPECT_TRUE(wrong.value().looksSwapped());
    layout.isBigEndian = true;
    EXPECT_FALSE(checkByteOrder(path, layout).value().looksSwapped());
    layout.type = ScalarType::U8;
    EXPECT_FALSE(checkByteOrder(path, layout).value().looksSwapped());
}

class RawImportModelTest : public ::testing::Test {
protected:
    std::unique_ptr<RawImportModel> make(const char* name, const std::string& bytes) {
        return std::make_unique<RawImportModel>(folder_.write(name, bytes), bytes.size(), jobs_, VolumeAccess());
    }
    bool settle(const RawImportModel& model) {
        return queue_.runUntil([&] {
            return !model.isRanking() && jobs_->jobs().runningCount() == 0 &&
                   model.preview().state() != PreviewModel::State::Loading;
        });
    }
    test::TemporaryFolder folder_;
    test::MainThreadQueue queue_;
    std::shared_ptr<BackgroundJobs> jobs_ = std::make_shared<BackgroundJobs>(queue_.poster());
};

TEST_F(RawImportModelTest, TakesTheBestGuessAndShowsIt) {
    const RawFile file{{36, 40, 20}, ScalarType::U16, true, 0, 4000.0};
    const auto model = make("scan.raw", bytesOf(file));
    ASSERT_TRUE(settle(*model));
    EXPECT_EQ(model->layout().dims, file.dims);
    EXPECT_EQ(model->chosenGuess(), 0u);
    EXPECT_TRUE(model->canOpen());
    EXPECT_EQ(model->swapWarning(), nullptr);
    ASSERT_EQ(model->preview().state(), PreviewModel::State::Ready);
    EXPECT_LE(model->preview().preview()->max, 4000.0);
    EXPECT_EQ(model->options().raw, model->layout());
}

TEST_F(RawImportModelTest, LeavesWhatTheUserTyped) {
    const auto model = make("scan.raw", bytesOf({{40, 30, 24}}));
    io::RawLayout typed;
    typed.dims = {30, 40, 24};
    typed.spacing = {1.0, 1.0, 2.0};
    model->setLayout(typed); // before the guesses are there
    ASSERT_TRUE(settle(*model));
    EXPECT_EQ(model->layout(), typed);
    model->takeGuess(0);
    EXPECT_EQ(model->layout().dims, (GridDims{40, 30, 24}));
    EXPECT_EQ(model->layout().spacing, typed.spacing) << "no byte of the file says otherwise";
    model->takeGuess(99);
    EXPECT_EQ(model->chosenGuess(), 0u);
}

TEST_F(RawImportModelTest, SaysWhatFits) {
    using Fit = RawImportModel::Fit;
    const auto model = make("scan.raw", bytesOf({{16, 16, 16}}));
    ASSERT_TRUE(settle(*model));
    EXPECT_EQ(model->fit(), Fit::Exact);
    auto layout = model->layout();
    layout.dims[2] = 15;
    model->setLayout(layout);
    EXPECT_EQ(model->fit(), Fit::FileLonger);
    EXPECT_FALSE(model->canOpen());
    ASSERT_TRUE(settle(*model));
    EXPECT_NE(model->preview().preview(), nullptr) << "seen although it cannot be opened yet";
    model->setAllowsTrailing(true);
    EXPECT_TRUE(model->canOpen());
    EXPECT_TRUE(model->options().allowsTrailing);
    layout.dims[2] = 17;
    model->setLayout(layout);
    EXPECT_EQ(model->fit(), Fit::FileShorter);
    EXPECT_FALSE(model->canOpen());
    EXPECT_EQ(model->preview().preview(), nullptr);
    layout.dims = {kMaxDim, kMaxDim, kMaxDim};
    layout.type = ScalarType::F64;
    model->setLayout(layout);
    EXPECT_EQ(model->fit(), Fit::FileShorter);
    layout.dims[0] = 1;
    model->setLayout(layout);
    EXPECT_EQ(model->fit(), Fit::NoVolume);
}

TEST_F(RawImportModelTest, WarnsOfSwappedBytesAndSwapsThem) {
    const auto model = make("scan.raw", bytesOf({{36, 40, 20}, ScalarType::U16, true, 0, 4000.0}));
    ASSERT_TRUE(settle(*model));
    model->swapByteOrder();
    ASSERT_TRUE(settle(*model));
    EXPECT_FALSE(model->layout().isBigEndian);
    ASSERT_NE(model->swapWarning(), nullptr);
    EXPECT_TRUE(model->canOpen()) << "a warning, not a refusal";
    model->swapByteOrder();
    ASSERT_TRUE(settle(*model));
    EXPECT_EQ(model->swapWarning(), nullptr);
}

} // namespace
} // namespace isoslider::model
