#include "preprocess/metacells/brick_list.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "core/base/memory_file_system.h"
#include "core/grid/classification.h"
#include "core/grid/gradient.h"
#include "core/index/index_reader.h"
#include "preprocess/levels/block_intervals.h"
#include "preprocess/levels/external_sort.h"
#include "preprocess/levels/level_builder.h"
#include "preprocess/missing_cells.h"

namespace isoslider::preprocess {
namespace {

// The upward edge number that stays in the box; -1 for a brick of one point, which has no edges.
int edgeOfBrick(const BrickGrid& grid, BrickIndex brick) {
    const auto coords = grid.brickCoords(brick);
    for (int axis = 0; axis < 3; ++axis)
        if (coords[static_cast<std::size_t>(axis)] * kBrickSide + 1 < grid.dims()[axis])
            return 2 * axis + 1;
    return -1;
}

} // namespace

template <class Key>
Status writeBrickList(const BrickSpans<Key>& spans, const GridDims& dims, const BrickListOptions& options,
                      const std::filesystem::path& spillPath, FileSystem& fileSystem, index::IndexWriter& writer,
                      std::vector<index::SkipLevelInfo>& levels, const JobControl& job) {
    const BrickGrid grid(dims);
    const auto isEverActive = [&](std::size_t brick) {
        return spans.least[brick] < spans.greatest[brick] && edgeOfBrick(grid, BrickIndex(brick)) >= 0;
    };
    KeyCounter<Key> counter(2 * spans.least.size());
    for (std::size_t brick = 0; brick < spans.least.size(); ++brick)
        if (isEverActive(brick)) {
            counter.add(spans.least[brick]);
            counter.add(spans.greatest[brick]);
        }
    std::vector<KeyCount> counts = counter.takeCounts();
    const KeyIntervals bins = makeSpanBins(counts);
    SpanHistogram histogram(bins.count());
    ExternalSort<Key> sort(counts, options.memoryBytes, spillPath, fileSystem);
    std::vector<KeyCount>().swap(counts);
    for (std::size_t brick = 0; brick < spans.least.size(); ++brick) {
        if (brick % 4096 == 0 && job.isStopRequested())
            return cancelledError();
        if (!isEverActive(brick))
            continue;
        histogram.add(bins.find(spans.least[brick]), bins.find(spans.greatest[brick]));
        const int edge = edgeOfBrick(grid, BrickIndex(brick));
        std::array<index::PointRecord<Key>, 2> records;
        for (std::size_t k = 0; k < 2; ++k) {
            records[k].key = k == 0 ? spans.least[brick] : spans.greatest[brick];
            records[k].setId(pointIn(BrickIndex(brick), LocalPoint()));
            records[k].edgeMask = static_cast<std::uint8_t>(1 << edge);
            records[k].farKeys[edge] = k == 0 ? spans.greatest[brick] : spans.least[brick];
        }
        ISO_TRY(sort.add(records));
    }
    LevelBuilder<Key> builder(writer, grid, index::FarEnds::Keys,
                              chooseBlockBegins(histogram, bins, options.skipLevels, options.redundancyThreshold));
    ISO_TRY(sort.drain([&](std::span<const index::PointRecord<Key>> records) { return builder.add(records); }, job));
    ISO_TRY(builder.finish());
    levels = builder.levelInfos();
    return {};
}

template Status writeBrickList(const BrickSpans<std::uint16_t>&, const GridDims&, const BrickListOptions&,
                               const std::filesystem::path&, FileSystem&, index::IndexWriter&,
                               std::vector<index::SkipLevelInfo>&, const JobControl&);
template Status writeBrickList(const BrickSpans<std::uint32_t>&, const GridDims&, const BrickListOptions&,
                               const std::filesystem::path&, FileSystem&, index::IndexWriter&,
                               std::vector<index::SkipLevelInfo>&, const JobControl&);
template Status writeBrickList(const BrickSpans<std::uint64_t>&, const GridDims&, const BrickListOptions&,
                               const std::filesystem::path&, FileSystem&, index::IndexWriter&,
                               std::vector<index::SkipLevelInfo>&, const JobControl&);

namespace {

// One pass over a volume in memory, brick by brick.
template <class Sample>
class MemoryScan {
public:
    using Key = KeyOf<Sample>;

    MemoryScan(const ScalarGrid& grid, const JobControl& job)
        : bricks_(grid.dims()), view_{grid.values<Sample>().data(), grid.dims()}, job_(job) {
        spans_.least.resize(bricks_.brickCount());
        spans_.greatest.resize(bricks_.brickCount());
    }

    Status run() {
        const std::size_t count = spans_.least.size();
        std::vector<std::uint8_t> hasMissing(count, 0);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t brick) {
            if (!job_.isStopRequested())
                hasMissing[brick] = scanBrick(BrickIndex(brick));
        });
        if (job_.isStopRequested())
            return cancelledError();
        index::MissingCells missing;
        const auto isCellValid = [&](auto... cell) { return view_.isCellValid(cell...); };
        for (std::size_t brick = 0; brick < count; ++brick)
            if (hasMissing[brick] && findMissingCells(bricks_, BrickIndex(brick), isCellValid, missing))
                missingCells_.push_back(missing);
        return {};
    }

    const BrickSpans<Key>& spans() const { return spans_; }
    std::vector<index::MissingCells> takeMissingCells() { return std::move(missingCells_); }

private:
    // True when a sample is missing.
    bool scanBrick(BrickIndex brick) {
        const auto coords = bricks_.brickCoords(brick);
        std::array<std::int64_t, 3> begin, end;
        for (std::size_t a = 0; a < 3; ++a) {
            begin[a] = coords[a] * kBrickSide;
            end[a] = std::min(begin[a] + kBrickSide + 1, view_.dims[a]);
        }
        Key least = std::numeric_limits<Key>::max(), greatest = 0;
        bool hasMissing = false;
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y) {
                const Sample* row = view_.samples + view_.offset(begin[0], y, z);
                const std::int64_t n = end[0] - begin[0];
                for (std::int64_t x = 0; x < n; ++x) {
                    if (isMissing(row[x])) {
                        hasMissing = true;
                        continue;
                    }
                    const Key key = keyOf(row[x]);
                    least = std::min(least, key);
                    greatest = std::max(greatest, key);
                }
            }
        spans_.least[brick.index()] = least;
        spans_.greatest[brick.index()] = greatest;
        return hasMissing;
    }

    BrickGrid bricks_;
    SampleView<Sample> view_;
    const JobControl& job_;
    BrickSpans<Key> spans_;
    std::vector<index::MissingCells> missingCells_;
};

template <class Sample>
Result<std::unique_ptr<extract::SlideEngine>> makeTypedEngine(std::shared_ptr<const ScalarGrid> grid,
                                                              const JobControl& job) {
    MemoryScan<Sample> scan(*grid, job);
    ISO_TRY(scan.run());
    MemoryFileSystem memory;
    const std::filesystem::path name = "bricks";
    auto writer = index::IndexWriter::create(name, 0, memory);
    if (!writer.isOk())
        return std::move(writer).error();
    index::IndexMeta meta;
    ISO_TRY(writeBrickList(scan.spans(), grid->dims(), {}, "bricks.sort", memory, *writer.value(), meta.info.levels));
    meta.info.kind = index::IndexKind::BrickList;
    meta.info.geometry = grid->geometry();
    meta.info.type = grid->type();
    meta.missingCells = scan.takeMissingCells();
    std::uint64_t least = ~std::uint64_t{0}, greatest = 0;
    for (std::size_t brick = 0; brick < scan.spans().least.size(); ++brick)
        if (scan.spans().least[brick] <= scan.spans().greatest[brick]) {
            least = std::min<std::uint64_t>(least, scan.spans().least[brick]);
            greatest = std::max<std::uint64_t>(greatest, scan.spans().greatest[brick]);
        }
    if (least > greatest)
        return makeError(ErrorCode::InvalidArgument, "the volume has no finite sample");
    meta.info.min = static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(least)));
    meta.info.max = static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(greatest)));
    if (auto finished = writer.value()->finish(std::move(meta)); !finished.isOk())
        return std::move(finished).error();
    auto reader = index::IndexReader::open(name, memory);
    if (!reader.isOk())
        return std::move(reader).error();
    return extract::SlideEngine::onVolume(std::move(grid), std::move(reader).value());
}

} // namespace

Result<std::unique_ptr<extract::SlideEngine>> makeMemoryEngine(std::shared_ptr<const ScalarGrid> grid,
                                                               const JobControl& job) {
    return visitScalarType(grid->type(), [&](auto sample) { return makeTypedEngine<decltype(sample)>(grid, job); });
}

} // namespace isoslider::preprocess
