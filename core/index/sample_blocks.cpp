#include "core/index/sample_blocks.h"

#include <algorithm>
#include <utility>

#include "core/grid/classification.h"
#include "core/index/index_reader.h"
#include "core/index/sample_store.h"

namespace isoslider::index {

SampleBlocks::SampleBlocks(const GridDims& dims) : dims_(dims) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        count_[axis] = (dims[axis] + kSide - 1) / kSide;
    blocks_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
}

const double* SampleBlocks::load(std::size_t number, const std::array<std::int64_t, 3>& block) {
    if (!status_.isOk())
        return nullptr;
    if (kept_.size() >= kMostBlocks) { // a walk seldom comes back to where it was long ago
        for (const std::size_t each : kept_)
            blocks_[each].reset();
        kept_.clear();
    }
    auto samples = std::make_unique<double[]>(kSamples);
    status_ = read(block, std::span<double, kSamples>(samples.get(), kSamples));
    if (!status_.isOk())
        return nullptr;
    kept_.push_back(number);
    blocks_[number] = std::move(samples);
    return blocks_[number].get();
}

namespace {

template <class Sample>
double placedSample(Sample sample) {
    return isMissing(sample) ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(sample);
}

class MemoryBlocks final : public SampleBlocks {
public:
    explicit MemoryBlocks(std::shared_ptr<const ScalarGrid> grid)
        : SampleBlocks(grid->dims()), grid_(std::move(grid)) {}

private:
    Status read(const std::array<std::int64_t, 3>& block, std::span<double, kSamples> out) override {
        std::array<std::int64_t, 3> begin{}, count{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            begin[axis] = block[axis] * kSide;
            count[axis] = std::min(kSide, dims()[axis] - begin[axis]);
        }
        grid_->visit([&](auto samples) {
            for (std::int64_t z = 0; z < count[2]; ++z)
                for (std::int64_t y = 0; y < count[1]; ++y) {
                    const auto first =
                        static_cast<std::size_t>(begin[0] + dims()[0] * (begin[1] + y + dims()[1] * (begin[2] + z)));
                    for (std::int64_t x = 0; x < count[0]; ++x)
                        out[static_cast<std::size_t>(x + kSide * (y + kSide * z))] =
                            placedSample(samples[first + static_cast<std::size_t>(x)]);
                }
        });
        return {};
    }

    std::shared_ptr<const ScalarGrid> grid_;
};

template <class Sample>
class StoredBlocks final : public SampleBlocks {
public:
    explicit StoredBlocks(std::unique_ptr<IndexReader> reader)
        : SampleBlocks(reader->info().geometry.dims), reader_(std::move(reader)), store_(*reader_) {
        static_assert(SampleStore::kChunkSamples == kSamples && kChunkSide == kSide);
    }

private:
    Status read(const std::array<std::int64_t, 3>& block, std::span<double, kSamples> out) override {
        std::uint64_t bytesRead = 0;
        ISO_TRY(store_.read<Sample>(store_.chunks().chunkAt(block[0], block[1], block[2]),
                                    std::span<Sample, kSamples>(decoded_), bytesRead));
        std::transform(decoded_.begin(), decoded_.end(), out.begin(), placedSample<Sample>);
        return {};
    }

    std::unique_ptr<IndexReader> reader_;
    SampleStore store_;
    std::array<Sample, kSamples> decoded_{};
};

} // namespace

std::shared_ptr<SampleBlocks> makeSampleBlocks(std::shared_ptr<const ScalarGrid> grid) {
    return std::make_shared<MemoryBlocks>(std::move(grid));
}

Result<std::shared_ptr<SampleBlocks>> openSampleBlocks(const std::filesystem::path& indexPath) {
    auto reader = IndexReader::open(indexPath);
    if (!reader.isOk())
        return reader.error();
    return visitScalarType(reader.value()->info().type, [&](auto sample) -> std::shared_ptr<SampleBlocks> {
        return std::make_shared<StoredBlocks<decltype(sample)>>(std::move(reader).value());
    });
}

} // namespace isoslider::index
