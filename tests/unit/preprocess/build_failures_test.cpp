// Builds that do not come to their end: nothing is left, and an earlier index stays what it was.

#include <cerrno>

#include <gtest/gtest.h>

#include "core/extract/slide_engine.h"
#include "core/index/format/index_format.h"
#include "preprocess/build_index.h"
#include "tests/property/test_volumes.h"
#include "tests/support/faulty_file_system.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::preprocess {
namespace {

using test::HasError;
using test::IsOk;

class BuildFailure : public testing::TestWithParam<index::IndexKind> {
protected:
    static BuildOptions options(FileSystem* fileSystem = nullptr) {
        BuildOptions options;
        options.kind = GetParam();
        options.fileSystem = fileSystem;
        return options;
    }

    void SetUp() override {
        ASSERT_THAT(test::buildIndexOf(test::noiseVolume({6, 6, 6}, 8), folder_ / "a.isx", options()), IsOk());
        earlier_ = test::readText(folder_ / "a.isx");
    }

    void expectEarlierIndexOnly() {
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.isx"});
        EXPECT_TRUE(test::readText(folder_ / "a.isx") == earlier_);
    }

    void expectEveryFailingCallLeavesTheEarlierIndex();

    test::TemporaryFolder folder_;
    std::string earlier_;
    std::shared_ptr<const ScalarGrid> grid_ = test::hillsVolume({24, 20, 33});
};

TEST_P(BuildFailure, CancellingAtAnyReportLeavesTheEarlierIndex) {
    int reports = 0;
    JobControl counting;
    counting.progress = [&](double, std::string_view) { ++reports; };
    const test::TemporaryFolder other;
    ASSERT_THAT(test::buildIndexOf(grid_, other / "b.isx", options(), counting), IsOk());
    ASSERT_GE(reports, 4);
    for (int at = 0; at < reports; ++at) {
        std::stop_source stop;
        int seen = 0;
        JobControl job;
        job.stop = stop.get_token();
        job.progress = [&](double, std::string_view) {
            if (seen++ == at)
                stop.request_stop();
        };
        ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "a.isx", options(), job), HasError(ErrorCode::Cancelled))
            << "report " << at;
        expectEarlierIndexOnly();
    }
}

// Closing is the last call: the index has its name by then, and whatever closing states does not undo that.
void BuildFailure::expectEveryFailingCallLeavesTheEarlierIndex() {
    const test::TemporaryFolder other;
    test::FaultyFileSystem counting(-1, 0);
    ASSERT_THAT(test::buildIndexOf(grid_, other / "a.isx", options(&counting)), IsOk());
    const std::string later = test::readText(other / "a.isx");
    bool hasSucceeded = false;
    for (int failing = 0; !hasSucceeded; ++failing) {
        ASSERT_LT(failing, 500);
        test::FaultyFileSystem faulty(failing, failing % 2 ? ENOSPC : EIO);
        const auto built = test::buildIndexOf(grid_, folder_ / "a.isx", options(&faulty));
        hasSucceeded = failing >= faulty.calls();
        const bool isClosing = failing == counting.calls() - 1;
        EXPECT_EQ(built.isOk(), hasSucceeded || isClosing) << "call " << failing;
        if (built.isOk()) {
            EXPECT_TRUE(test::readText(folder_ / "a.isx") == later) << "call " << failing;
        } else {
            EXPECT_EQ(built.error().code, failing % 2 ? ErrorCode::OutOfSpace : ErrorCode::IoError);
            EXPECT_FALSE(built.error().path.empty());
            EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.isx"});
            const std::string now = test::readText(folder_ / "a.isx");
            EXPECT_TRUE(now == earlier_) << "call " << failing;
        }
    }
    EXPECT_TRUE(test::readText(folder_ / "a.isx") == later);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.isx"});
}

TEST_P(BuildFailure, B091_EveryFailingCallIsReportedAndLeavesTheEarlierIndex) {
    expectEveryFailingCallLeavesTheEarlierIndex();
}

TEST_P(BuildFailure, SoDoesEveryFailingCallAmongChunks) {
    grid_ = test::noiseVolume({48, 40, 33}, 2, 200);
    const test::TemporaryFolder other;
    const auto built = test::buildIndexOf(grid_, other / "a.isx", options());
    ASSERT_THAT(built, IsOk());
    ASSERT_GT(built.value().info.chunkBytes, 40000u);
    expectEveryFailingCallLeavesTheEarlierIndex();
}

// A source whose nth slab cannot be read.
class FailingSource final : public io::VolumeSource {
public:
    FailingSource(std::unique_ptr<io::VolumeSource> source, int failing)
        : source_(std::move(source)), failing_(failing) {}
    const io::VolumeInfo& info() const override { return source_->info(); }
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        if (reads_++ == failing_)
            return makeError(ErrorCode::Corruption, "volume ends early", "volume.raw", 99);
        return source_->readSlab(zBegin, zEnd, out);
    }
    bool hasFailed() const { return reads_ > failing_; }

private:
    std::unique_ptr<io::VolumeSource> source_;
    int failing_;
    int reads_ = 0;
};

TEST_P(BuildFailure, AnErrorOfTheSourceIsPassedOn) {
    for (int failing = 0;; ++failing) {
        ASSERT_LT(failing, 100);
        FailingSource source(io::makeMemorySource(grid_), failing);
        const auto built = buildIndex(source, folder_ / "a.isx", options());
        if (!source.hasFailed()) {
            EXPECT_THAT(built, IsOk());
            if (GetParam() == index::IndexKind::Edges) {
                EXPECT_EQ(failing, 17)
                    << "five layers twice and for a forecast, three slabs; where the last planes are there "
                       "already, one less";
            } else {
                EXPECT_EQ(failing, 5) << "three slabs for a forecast; 17 planes, and the rest";
            }
            break;
        }
        ASSERT_THAT(built, HasError(ErrorCode::Corruption));
        EXPECT_EQ(built.error().path, "volume.raw");
        EXPECT_EQ(built.error().offset, 99u);
        expectEarlierIndexOnly();
    }
}

TEST_P(BuildFailure, AnIndexBeingReadKeepsWorkingWhileItIsReplaced) {
    const auto engine = extract::SlideEngine::open(folder_ / "a.isx", {1});
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(5.0), IsOk());
    ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "a.isx", options()), IsOk());
    EXPECT_THAT(engine.value()->slideTo(12.0), IsOk()) << "still the file that was opened";
}

INSTANTIATE_TEST_SUITE_P(Kinds, BuildFailure, testing::Values(index::IndexKind::Edges, index::IndexKind::Metacells),
                         [](const auto& kind) { return std::string(index::indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::preprocess
