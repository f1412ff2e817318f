// What is chosen of a file of several volumes, without and with the workers that list and preview it.
#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/opening/open_model.h"
#include "ui/model/session/session.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;
namespace fs = std::filesystem;

io::VolumeField fieldOf(const char* name, const GridDims& dims) {
    io::VolumeField field;
    field.name = name;
    field.dims = dims;
    field.typeName = "float32";
    return field;
}

io::VolumeContents twoFields() {
    io::VolumeContents contents;
    contents.format = "made up";
    contents.fields = {fieldOf("pressure", {8, 8, 8}), fieldOf("velocity", {8, 8, 8})};
    contents.fields[1].components = 3;
    contents.fields[1].componentNames = {"u", "", "w"};
    contents.fields[1].frames = 5;
    return contents;
}

TEST(VolumeChoice, OfOneVolumeHasNothingToSay) {
    io::VolumeContents contents;
    contents.fields = {fieldOf("density", {8, 8, 8})};
    const VolumeChoice choice(contents);
    EXPECT_EQ(choice.options(), io::ReadOptions()) << "one set of options however a volume was opened";
    EXPECT_FALSE(choice.hasFields() || choice.hasComponents() || choice.hasFrames() || choice.hasSize());
}

TEST(VolumeChoice, NamesFieldComponentAndFrame) {
    VolumeChoice choice(twoFields());
    EXPECT_EQ(choice.options().field, "pressure");
    EXPECT_FALSE(choice.options().component || choice.options().frame);
    choice.setField(1);
    choice.setComponent(2);
    choice.setFrame(4);
    const auto options = choice.options();
    EXPECT_EQ(options.field, "velocity");
    EXPECT_EQ(options.component, 2);
    EXPECT_EQ(options.frame, 4);
    EXPECT_EQ(choice.componentNames(), (std::vector<std::string>{"u", "1", "w"}));
    choice.setComponent(io::kMagnitude);
    EXPECT_EQ(choice.options().component, io::kMagnitude);
}

TEST(VolumeChoice, BringsWhatIsOutOfRangeIntoIt) {
    VolumeChoice choice(twoFields());
    choice.setField(17);
    EXPECT_EQ(choice.fieldIndex(), 1u);
    choice.setComponent(3);
    EXPECT_EQ(choice.component(), 2);
    choice.setComponent(-2);
    EXPECT_EQ(choice.component(), 0);
    choice.setFrame(99);
    EXPECT_EQ(choice.frame(), 4);
    choice.setField(0);
    EXPECT_EQ(choice.frame(), 0) << "another field begins anew";
}

TEST(VolumeChoice, LeavesOutTheFieldThatTheFilePutsForward) {
    auto contents = twoFields();
    contents.isPreferredChosen = true;
    contents.preferred = 0;
    VolumeChoice choice(contents);
    EXPECT_EQ(choice.options(), io::ReadOptions());
    choice.setField(1);
    EXPECT_EQ(choice.options().field, "velocity");
}

TEST(VolumeChoice, ShowsTheModulusOfComplexSamplesFirst) {
    auto contents = twoFields();
    contents.fields[1].components = 2;
    contents.fields[1].componentNames = {"real", "imaginary"};
    contents.preferred = 1;
    EXPECT_EQ(VolumeChoice(contents).component(), io::kMagnitude);
}

TEST(VolumeChoice, ResamplesAPreviewToASmallSize) {
    io::VolumeContents contents;
    contents.fields = {fieldOf("density", {400, 200, 3})};
    contents.fields[0].isResampled = true;
    VolumeChoice choice(contents);
    EXPECT_EQ(choice.options().resampleDims, (GridDims{0, 0, 0})) << "the file's own size needs no word";
    EXPECT_EQ(choice.previewOptions().resampleDims, (GridDims{64, 32, 2}));
    choice.setSize({100, 1, 5});
    EXPECT_EQ(choice.options().resampleDims, (GridDims{100, 2, 5}));
    EXPECT_EQ(choice.problem(), "");
    choice.setSize({kMaxDim, kMaxDim, kMaxDim});
    EXPECT_NE(choice.problem(), "");
}

TEST(VolumeChoice, TellsWhyAFieldCannotBeOpened) {
    auto contents = twoFields();
    contents.fields[0].problem = "holds text";
    EXPECT_EQ(VolumeChoice(contents).problem(), "holds text");
    EXPECT_TRUE(isWorthAsking(contents));
    contents.fields[1].problem = "holds text";
    EXPECT_FALSE(isWorthAsking(contents)) << "nothing of it can be opened";
}

/// Readers that know two fields of a file, "pressure" and "velocity"; x, y, z make the samples.
VolumeAccess fakeReaders() {
    VolumeAccess volumes;
    volumes.list = [](const fs::path&, const io::ReadOptions&) -> Result<io::VolumeContents> { return twoFields(); };
    volumes.open = [](const fs::path& path,
                      const io::ReadOptions& options) -> Result<std::unique_ptr<io::VolumeSource>> {
        if (options.field.empty())
            return makeError(ErrorCode::InvalidArgument, "has fields 'pressure' and 'velocity'; choose one",
                             path.string());
        GridGeometry geometry;
        geometry.dims = {8, 8, 8};
        geometry.spacing = {1.0, 2.0, 3.0};
        std::vector<float> values;
        for (int i = 0; i < 512; ++i)
            values.push_back(options.field == "pressure" ? static_cast<float>(i)
                                                         : static_cast<float>(-i * *options.component));
        values[3] = std::numeric_limits<float>::quiet_NaN();
        return io::makeMemorySource(std::make_shared<const ScalarGrid>(
            ScalarGrid::fromValues(geometry, ScalarType::F32, std::span<const float>(values))));
    };
    return volumes;
}

TEST(VolumePreview, HasTheMiddleSlicesInTheirPlaces) {
    io::ReadOptions options;
    options.field = "pressure";
    const auto preview = readVolumePreview("a", options, fakeReaders(), {});
    ASSERT_THAT(preview, IsOk());
    const auto& shown = preview.value();
    EXPECT_EQ(shown.coarseStep, 1);
    EXPECT_EQ(shown.min, 0.0);
    EXPECT_EQ(shown.max, 511.0);
    EXPECT_EQ(shown.missingSamples, 1u);
    EXPECT_EQ(shown.slices[0].axis, 2);
    EXPECT_EQ(shown.slices[2].axis, 0);
    for (const auto& slice : shown.slices) {
        EXPECT_EQ(slice.position, 4);
        EXPECT_EQ(slice.shades.size(), 64u);
    }
    EXPECT_EQ(shown.slices[1].pixelWidth, 1.0); // across y: x along, z down
    EXPECT_EQ(shown.slices[1].pixelHeight, 3.0);
    EXPECT_EQ(shown.slices[2].pixelWidth, 2.0);
    EXPECT_LT(shown.slices[0].shades.front(), shown.slices[0].shades.back());
    EXPECT_LT(shown.slices[1].shades[0] + 100, shown.slices[1].shades[7 * 8]);
}

TEST(VolumePreview, IsCoarseWhenAllWouldBeTooMuch) {
    io::ReadOptions options;
    options.field = "pressure";
    const auto preview = readVolumePreview("a", options, fakeReaders(), {}, 64);
    ASSERT_THAT(preview, IsOk());
    EXPECT_EQ(preview.value().coarseStep, 2);
    EXPECT_EQ(preview.value().slices[0].position, 4) << "on the whole volume's axis";
    EXPECT_EQ(preview.value().slices[0].shades.size(), 16u);
    EXPECT_EQ(preview.value().info.geometry.dims, (GridDims{8, 8, 8}));
}

TEST(VolumePreview, AnOutlierDoesNotDarkenItsSlices) {
    VolumeAccess volumes;
    volumes.open = [](const fs::path&, const io::ReadOptions&) -> Result<std::unique_ptr<io::VolumeSource>> {
        GridGeometry geometry;
        geometry.dims = {20, 20, 20};
        std::vector<float> values(8000);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(i % 20);
        values[7] = 3e38f;
        for (std::size_t i = 0; i < 8000; i += 7)
            values[i] += 0.01f * static_cast<float>(i % 100);
        return io::makeMemorySource(std::make_shared<const ScalarGrid>(
            ScalarGrid::fromValues(geometry, ScalarType::F32, std::span<const float>(values))));
    };
    const auto preview = readVolumePreview("a", {}, volumes, {});
    ASSERT_THAT(preview, IsOk());
    EXPECT_GT(preview.value().max, 2e38);
    EXPECT_LT(preview.value().histogram.max, 30.0);
    const auto& shades = preview.value().slices[0].shades;
    EXPECT_GT(*std::max_element(shades.begin(), shades.end()), 200);
    EXPECT_LT(*std::min_element(shades.begin(), shades.end()), 50);
}

TEST(VolumePreview, OfMissingSamplesOnlyHasNoHistogram) {
    VolumeAccess volumes;
    volumes.open = [](const fs::path&, const io::ReadOptions&) -> Result<std::unique_ptr<io::VolumeSource>> {
        GridGeometry geometry;
        geometry.dims = {2, 2, 2};
        const std::vector<float> values(8, std::numeric_limits<float>::quiet_NaN());
        return io::makeMemorySource(std::make_shared<const ScalarGrid>(
            ScalarGrid::fromValues(geometry, ScalarType::F32, std::span<const float>(values))));
    };
    const auto preview = readVolumePreview("a", {}, volumes, {});
    ASSERT_THAT(preview, IsOk());
    EXPECT_EQ(preview.value().missingSamples, 8u);
    EXPECT_TRUE(preview.value().histogram.counts.empty());
    EXPECT_EQ(preview.value().slices[0].shades[0], SliceImage::kMissing);
}

class OpenModelTest : public ::testing::Test {
protected:
    bool waitUntilReady(const OpenModel& model) {
        return queue_.runUntil([&] { return model.preview().state() == PreviewModel::State::Ready; });
    }
    test::MainThreadQueue queue_;
    std::shared_ptr<BackgroundJobs> jobs_ = std::make_shared<BackgroundJobs>(queue_.poster());
};

TEST_F(OpenModelTest, ListsThenPreviewsWhatIsChosen) {
    OpenModel model("a", jobs_, fakeReaders());
    EXPECT_EQ(model.state(), OpenModel::State::Listing);
    EXPECT_FALSE(model.canOpen());
    ASSERT_TRUE(waitUntilReady(model));
    EXPECT_EQ(model.state(), OpenModel::State::Ready);
    EXPECT_TRUE(model.canOpen());
    EXPECT_EQ(model.preview().preview()->max, 511.0);
    model.change([](VolumeChoice& choice) {
        choice.setField(1);
        choice.setComponent(2);
    });
    EXPECT_EQ(model.preview().state(), PreviewModel::State::Loading);
    ASSERT_TRUE(waitUntilReady(model));
    EXPECT_EQ(model.preview().preview()->min, -1022.0);
}

TEST_F(OpenModelTest, TellsWhyNothingCanBeListed) {
    auto readers = fakeReaders();
    readers.list = [](const fs::path&, const io::ReadOptions&) -> Result<io::VolumeContents> {
        return makeError(ErrorCode::Corruption, "is broken", "a");
    };
    OpenModel model("a", jobs_, readers);
    ASSERT_TRUE(queue_.runUntil([&] { return model.state() == OpenModel::State::Failed; }));
    EXPECT_EQ(model.error().message, "is broken");
    EXPECT_FALSE(model.canOpen());
    readers.list = [](const fs::path&, const io::ReadOptions&) -> Result<io::VolumeContents> {
        return io::VolumeContents();
    };
    OpenModel empty("a", jobs_, readers);
    EXPECT_TRUE(queue_.runUntil([&] { return empty.state() == OpenModel::State::Failed; }));
}

TEST_F(OpenModelTest, ShowsNothingOfAFieldThatCannotBeOpened) {
    auto contents = twoFields();
    contents.fields[1].problem = "holds text";
    OpenModel model("a", contents, jobs_, fakeReaders());
    ASSERT_TRUE(waitUntilReady(model));
    model.change([](VolumeChoice& choice) { choice.setField(1); });
    EXPECT_FALSE(model.canOpen());
    EXPECT_EQ(model.preview().preview(), nullptr);
    model.change([](VolumeChoice& choice) { choice.setField(0); });
    ASSERT_TRUE(waitUntilReady(model));
    EXPECT_TRUE(model.canOpen());
}

TEST_F(OpenModelTest, TheNewestChoiceWinsAndClosingDoesNotWait) {
    auto readers = fakeReaders();
    auto isHeld = std::make_shared<std::atomic<bool>>(true);
    auto opened = std::make_shared<std::atomic<int>>(0);
    readers.open = [open = readers.open, isHeld, opened](const fs::path& path, const io::ReadOptions& options) {
        ++*opened;
        while (*isHeld)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return open(path, options);
    };
    auto model = std::make_unique<OpenModel>("a", twoFields(), jobs_, readers);
    ASSERT_TRUE(queue_.runUntil([&] { return *opened == 1; }));
    for (int component = 0; component < 3; ++component)
        model->change([&](VolumeChoice& choice) {
            choice.setField(1);
            choice.setComponent(component);
        });
    EXPECT_EQ(*opened, 1) << "one at a time";
    *isHeld = false;
    ASSERT_TRUE(waitUntilReady(*model));
    EXPECT_EQ(model->preview().preview()->min, -1022.0) << "of the last component";
    EXPECT_EQ(*opened, 2) << "what was asked for between was never read";

    *isHeld = true;
    model->change([](VolumeChoice& choice) { choice.setComponent(0); });
    ASSERT_TRUE(queue_.runUntil([&] { return *opened == 3; }));
    model.reset(); // while its worker is held
    *isHeld = false;
    EXPECT_TRUE(queue_.runUntil([&] { return jobs_->jobs().runningCount() == 0; }));
}

class ChoosingSessionTest : public ::testing::Test {
protected:
    void make(const VolumeAccess& volumes) {
        SessionServices services;
        services.postToMain = queue_.poster();
        services.volumes = volumes;
        services.cacheFolder = folder_ / "cache";
        session_ = std::make_unique<Session>(std::move(services));
        subscriptions_.push_back(
            session_->choiceNeeded().observe([this](const OpenRequest& request, const io::VolumeContents& contents) {
                asked_ = request;
                contents_ = contents;
            }));
        subscriptions_.push_back(
            session_->noticePosted().observe([this](const Notice& notice) { notices_.push_back(notice); }));
    }
    bool open(bool asks, const char* field = "") {
        OpenRequest request;
        request.path = folder_ / "a.made-up";
        request.asksForChoice = asks;
        request.readOptions.field = field;
        request.isovalue = 100.0;
        session_->open(request);
        return queue_.runUntil([this] { return !session_->isLoading(); });
    }
    test::TemporaryFolder folder_;
    test::MainThreadQueue queue_;
    std::unique_ptr<Session> session_;
    std::optional<OpenRequest> asked_;
    io::VolumeContents contents_;
    std::vector<Notice> notices_;
    std::vector<Subscription> subscriptions_;
};

TEST_F(ChoosingSessionTest, AsksInsteadOfFailing) {
    make(fakeReaders());
    ASSERT_TRUE(open(true));
    ASSERT_TRUE(asked_);
    EXPECT_EQ(asked_->isovalue, 100.0);
    EXPECT_EQ(contents_.fields.size(), 2u);
    EXPECT_TRUE(notices_.empty());
    EXPECT_EQ(session_->dataset(), nullptr);
    ASSERT_TRUE(open(true, "pressure"));
    ASSERT_NE(session_->dataset(), nullptr);
    EXPECT_EQ(session_->dataset()->missingSamples, 1u);
}

TEST_F(ChoosingSessionTest, FailsWhenNobodyWouldAnswer) {
    make(fakeReaders());
    ASSERT_TRUE(open(false));
    EXPECT_FALSE(asked_);
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_NE(notices_[0].detail.find("choose one"), std::string::npos);
}

TEST_F(ChoosingSessionTest, KeepsTheErrorOfAFileThatIsJustBroken) {
    auto readers = fakeReaders();
    readers.list = [](const fs::path&, const io::ReadOptions&) -> Result<io::VolumeContents> {
        io::VolumeContents contents = twoFields();
        contents.fields.pop_back();
        return contents;
    };
    make(readers);
    ASSERT_TRUE(open(true));
    EXPECT_FALSE(asked_);
    EXPECT_EQ(notices_.size(), 1u);
}

TEST_F(ChoosingSessionTest, CancellingKeepsWhatIsOpen) {
    auto readers = fakeReaders();
    auto isHeld = std::make_shared<std::atomic<bool>>(false);
    readers.read = [read = readers.read, isHeld](io::VolumeSource& source, const fs::path& path,
                                                 const JobControl& job) {
        while (*isHeld && !job.isStopRequested())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return job.isStopRequested() ? cancelledError() : read(source, path, job);
    };
    make(readers);
    ASSERT_TRUE(open(true, "pressure"));
    const auto key = session_->datasetGeneration();
    *isHeld = true;
    OpenRequest request;
    request.path = folder_ / "b.made-up";
    request.readOptions.field = "pressure";
    session_->open(request);
    ASSERT_NE(session_->loading(), nullptr);
    session_->cancelOpening();
    ASSERT_TRUE(queue_.runUntil([this] { return !session_->isLoading(); }));
    EXPECT_EQ(session_->datasetGeneration(), key);
    EXPECT_TRUE(notices_.empty());
    EXPECT_EQ(session_->loading(), nullptr);
}

} // namespace
} // namespace isoslider::model
