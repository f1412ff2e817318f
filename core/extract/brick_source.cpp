#include "core/extract/brick_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <exception>
#include <system_error>
#include <utility>

#include <glm/common.hpp>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include "core/base/job_control.h"
#include "core/extract/brick.h"
#include "core/extract/brick_signs.h"
#include "core/grid/edge_cells.h"

namespace isoslider::extract {
namespace {

std::array<BrickBits, 3> edgesOf(const SignWords& words, const std::array<BrickBits, 3>& inside) {
    std::array<BrickBits, 3> edges;
    for (std::size_t z = 0; z < 8; ++z) {
        edges[0][z] = (words.here[z] ^ words.right[z]) & inside[0][z];
        edges[1][z] = (words.here[z] ^ words.behind[z]) & inside[1][z];
        edges[2][z] = (words.here[z] ^ words.here[z + 1]) & inside[2][z];
    }
    return edges;
}

// Edges of the brick that lie in the box.
std::array<BrickBits, 3> edgesInside(const std::array<int, 3>& end) {
    std::array<BrickBits, 3> inside{};
    for (int axis = 0; axis < 3; ++axis) {
        std::array<int, 3> count;
        for (int a = 0; a < 3; ++a)
            count[static_cast<std::size_t>(a)] = std::clamp(end[static_cast<std::size_t>(a)] - (a == axis ? 1 : 0), 0, 8);
        const std::uint64_t row = 0xffu >> (8 - count[0]);
        const std::uint64_t plane = count[1] == 0 ? 0 : row * (0x0101010101010101ull >> (8 * (8 - count[1])));
        for (int z = 0; z < count[2]; ++z)
            inside[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)] = plane;
    }
    return inside;
}

} // namespace

template <class Sample>
struct BrickSource<Sample>::Scratch {
    SampleBlock<Sample> block;
    std::array<NormalCode, 9 * 9 * 9> normals;
    std::array<std::uint64_t, 12> hasNormal; // bit per point
    std::uint64_t bricks = 0, changed = 0;
    typename ChangeSet<Live>::Lists* lists = nullptr; // of this thread and move

    NormalCode normalAt(int x, int y, int z, const glm::vec3& inverseSpacing) {
        const auto at = static_cast<std::size_t>(x + 9 * (y + 9 * z));
        if (!(hasNormal[at >> 6] >> (at & 63) & 1)) {
            hasNormal[at >> 6] |= std::uint64_t{1} << (at & 63);
            normals[at] = encodeNormal(normalizedOrZero(-block.gradient(x, y, z, inverseSpacing)));
        }
        return normals[at];
    }
};

template <class Sample>
BrickSource<Sample>::BrickSource(const index::IndexReader& bricks, SampleReader<Sample>& samples,
                                 std::uint64_t cacheBytes)
    : WalkedSource<Sample>(bricks, cacheBytes), samples_(samples), placeOf_(bricks.grid().brickCount()) {
    for (int a = 0; a < 3; ++a) // rounded as where edge blocks are made
        inverseSpacing_[a] = static_cast<float>(1.0 / std::abs(bricks.info().geometry.spacing[a]));
}

template <class Sample>
void BrickSource<Sample>::removeActive(BrickIndex brick) {
    const std::uint32_t place = placeOf_[brick];
    if (place == 0)
        return;
    active_[place - 1] = active_.back();
    placeOf_[active_.back().brick] = place;
    active_.pop_back();
    placeOf_[brick] = 0;
}

// Bricks that come or go between two thresholds.
template <class Sample>
Status BrickSource<Sample>::netBricks(KeyThreshold lower, KeyThreshold upper, bool goesUp, SlideStats& stats,
                                      std::stop_token stop, NetBricks& net) {
    tbb::enumerable_thread_specific<NetBricks> nets;
    const auto take = [&](const Part& part) {
        NetBricks& local = nets.local();
        std::size_t entry = part.firstEntry;
        for (std::size_t i = part.begin; i < part.end; ++i, ++entry) { // one entry a record
            const std::uint64_t far = part.page.farKeys[entry];
            if (far >= lower && far < upper)
                continue; // comes and goes within the move
            const auto brick = static_cast<BrickIndex>(part.page.ids[i] / kBrickPoints);
            ((far > part.page.keys[i]) == goesUp ? local.arrive : local.leave).push_back(brick);
        }
        return entry;
    };
    ISO_TRY(walk_.visit(lower, upper, stats, stop, take));
    for (const NetBricks& local : nets) {
        net.arrive.insert(net.arrive.end(), local.arrive.begin(), local.arrive.end());
        net.leave.insert(net.leave.end(), local.leave.begin(), local.leave.end());
    }
    return {};
}

template <class Sample>
Status BrickSource<Sample>::changeActiveSet(KeyThreshold lower, KeyThreshold upper, bool goesUp,
                                            ChangeSet<Live>& changes, SlideStats& stats,
                                            std::stop_token stop) {
    NetBricks net;
    ISO_TRY(netBricks(lower, upper, goesUp, stats, stop, net));
    typename ChangeSet<Live>::Lists& lists = changes.local();
    for (const BrickIndex brick : net.leave) {
        removeActive(brick);
        lists.cleared[changes.partitionOf(brick)].push_back(brick);
    }
    for (const BrickIndex brick : net.arrive) {
        if (placeOf_[brick] != 0)
            return makeError(ErrorCode::Corruption, "index contradicts itself: a brick becomes active twice", reader_.pathString());
        active_.push_back({0, 0, brick, true});
        placeOf_[brick] = static_cast<std::uint32_t>(active_.size());
    }
    return {};
}

// `bricks` and the active ones that a move crosses, as their samples lie, forwards or backwards.
template <class Sample>
std::vector<BrickIndex> BrickSource<Sample>::inReadingOrder(std::vector<BrickIndex> bricks, KeyThreshold from, KeyThreshold to,
                                                            bool backwards) const {
    for (const ActiveBrick& active : active_)
        if (isCrossed(active, from, to))
            bricks.push_back(active.brick);
    struct Placed {
        std::uint64_t order;
        BrickIndex brick;
    };
    std::vector<Placed> placed;
    placed.reserve(bricks.size());
    for (const BrickIndex brick : bricks)
        placed.push_back({samples_.orderOf(brick), brick});
    tbb::parallel_sort(placed.begin(), placed.end(), [backwards](const Placed& a, const Placed& b) {
        return backwards ? a.order > b.order : a.order < b.order;
    });
    std::transform(placed.begin(), placed.end(), bricks.begin(), [](const Placed& p) { return p.brick; });
    return bricks;
}

template <class Sample>
Status BrickSource<Sample>::collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats, std::stop_token stop) {
    ahead_ = {}; // stops it
    stats.bytesAhead += std::exchange(bytesAhead_, 0);
    if (from == lowest() || from == highest()) { // nothing is active there; perhaps a move was broken off
        for (const ActiveBrick& active : active_)
            placeOf_[active.brick] = 0;
        active_.clear();
    }
    ISO_TRY(changeActiveSet(std::min(from, to), std::max(from, to), from < to, changes, stats, stop));

    readsBackwards_ = !readsBackwards_;
    const std::vector<BrickIndex> bricks = inReadingOrder({}, from, to, readsBackwards_);

    tbb::enumerable_thread_specific<Scratch> scratches;
    for (std::span<const BrickIndex> rest(bricks); !rest.empty();) {
        const auto ready = samples_.prepare(rest, stats, stop);
        if (!ready.isOk())
            return ready.error();
        const tbb::blocked_range<std::size_t> all(0, ready.value(), 32);
        tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
            Scratch& scratch = scratches.local();
            for (std::size_t i = range.begin(); i < range.end() && !stop.stop_requested(); ++i)
                emit(active_[placeOf_[rest[i]] - 1], from, to, changes, scratch);
        });
        if (stop.stop_requested())
            return cancelledError();
        rest = rest.subspan(ready.value());
    }
    for (const Scratch& scratch : scratches) {
        stats.bricksRead += scratch.bricks;
        stats.edgesTouched += scratch.changed;
    }
    return {};
}

template <class Sample>
void BrickSource<Sample>::foresee(KeyThreshold from, KeyThreshold to) {
    // More than that is a jump, of which there is no knowing where the next one goes.
    constexpr std::uint64_t kMaxEntries = 1u << 16;
    if (from == to || !samples_.fetchesAhead() || this->estimate(from, to) > kMaxEntries)
        return;
    // If anything goes wrong, the move itself will say so; without a thread, nothing is read ahead.
    try {
        ahead_ = std::jthread([this, from, to](std::stop_token stop) {
            try {
                (void)readAhead(from, to, stop);
            } catch (const std::exception&) {
            }
        });
    } catch (const std::system_error&) {
    }
}

template <class Sample>
Status BrickSource<Sample>::readAhead(KeyThreshold from, KeyThreshold to, std::stop_token stop) {
    tbb::task_arena one(1); // the picture is being drawn meanwhile
    return one.execute([&]() -> Status {
        SlideStats stats;
        NetBricks net;
        Status fetched = netBricks(std::min(from, to), std::max(from, to), from < to, stats, stop, net);
        if (fetched.isOk())
            fetched = samples_.fetch(inReadingOrder(std::move(net.arrive), from, to, !readsBackwards_), stats, stop);
        bytesAhead_ = stats.bytesRead;
        return fetched;
    });
}

template <class Sample>
void BrickSource<Sample>::emit(ActiveBrick& active, KeyThreshold from, KeyThreshold to,
                               ChangeSet<Live>& changes, Scratch& scratch) const {
    SampleBlock<Sample>& block = scratch.block;
    samples_.read(active.brick, block);
    ++scratch.bricks;

    const BrickSigns signs = findBrickSigns(block, from, to);
    const std::array<BrickBits, 3> inside = edgesInside(block.end);
    const std::array<BrickBits, 3> after = edgesOf(signs.to, inside);
    std::array<BrickBits, 3> before{};
    if (!active.isNew)
        before = edgesOf(signs.from, inside);
    active.up = signs.up;
    active.down = signs.down;
    active.isNew = false;

    scratch.hasNormal.fill(0);
    if (!scratch.lists)
        scratch.lists = &changes.local();
    const unsigned partition = changes.partitionOf(active.brick);
    auto& activated = scratch.lists->activated[partition];
    auto& deactivated = scratch.lists->deactivated[partition];
    const bool checksCells = signs.hasMissing || *std::min_element(block.end.begin(), block.end.end()) < 2;
    for (int axis = 0; axis < 3; ++axis)
        for (int z = 0; z < 8; ++z) {
            const std::uint64_t old = before[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)];
            const std::uint64_t now = after[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)];
            for (std::uint64_t word = old ^ now; word != 0; word &= word - 1) {
                const int bit = std::countr_zero(word);
                const int x = bit & 7, y = bit >> 3;
                if (checksCells && !hasWholeCell(x, y, z, axis, [&](auto... cell) { return block.isCellWhole(cell...); }))
                    continue;
                ++scratch.changed;
                const auto edge = static_cast<LocalEdge>(axis * kBrickPoints + bit + 64 * z);
                if (old >> bit & 1) {
                    deactivated.push_back({active.brick, edge});
                    continue;
                }
                const Sample* point = block.samples.data() + block.offset(x, y, z);
                const NormalCode normal1 = scratch.normalAt(x, y, z, inverseSpacing_);
                const NormalCode normal2 =
                    scratch.normalAt(x + (axis == 0), y + (axis == 1), z + (axis == 2), inverseSpacing_);
                activated.push_back({static_cast<Live>(point[0]), static_cast<Live>(point[block.stride(axis)]),
                                     active.brick, edge, normal1, normal2});
            }
        }
}

template <class Sample>
Result<std::optional<double>> BrickSource<Sample>::hiddenScalar(BrickIndex brick, LocalPoint cell, int corner) {
    const auto p = reader_.grid().pointCoords(PointId{brick} * kBrickPoints + cell);
    std::uint64_t bytesRead = 0;
    const auto sample =
        samples_.sampleAt(p[0] + (corner & 1), p[1] + (corner >> 1 & 1), p[2] + (corner >> 2), bytesRead);
    hiddenBytesRead_.fetch_add(bytesRead, std::memory_order_relaxed);
    if (!sample.isOk())
        return sample.error();
    return std::optional<double>(static_cast<double>(sample.value()));
}

template class BrickSource<std::uint8_t>;
template class BrickSource<std::int8_t>;
template class BrickSource<std::uint16_t>;
template class BrickSource<std::int16_t>;
template class BrickSource<std::int32_t>;
template class BrickSource<float>;
template class BrickSource<double>;

} // namespace isoslider::extract
