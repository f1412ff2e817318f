#include "core/extract/sources/stored_normals.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/base/worker_team.h"

namespace isoslider::extract {
namespace {

// The block that normals are read for ends with the brick's points.
constexpr int kApron = 0;
constexpr std::size_t kBricksAtOnce = 16;

void copyNormals(const SampleRows<NormalCode>& from, NormalCode* out) {
    std::fill_n(out, kPaddedPoints, kNoNormal);
    const auto endOf = [&](std::size_t axis) { return std::min(kPointSide, from.end[axis]); };
    const int own = std::min(kBrickSide, from.end[0]);
    for (int z = 0; z < endOf(2); ++z)
        for (int y = 0; y < endOf(1); ++y) {
            const auto row = from.row(y, z);
            NormalCode* const to = out + closedPoint(0, y, z).index();
            std::copy_n(row.own, own, to);
            if (endOf(0) > kBrickSide)
                to[kBrickSide] = *row.behind;
        }
}

} // namespace

StoredNormals::StoredNormals(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : chunks_(reader, cacheBytes, kApron) {
    ISO_CHECK(hasNormalChunks(reader.info()));
}

Status StoredNormals::read(std::span<const BrickIndex> bricks, const Place& placeOf, SlideStats& stats,
                           const JobControl& job) {
    for (std::size_t done = 0; done < bricks.size();) {
        const auto ready = chunks_.prepare(bricks.subspan(done), stats, job.stop);
        if (!ready.isOk())
            return ready.error();
        forRanges(ready.value(), kBricksAtOnce, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = done + begin; i < done + end; ++i)
                copyNormals(chunks_.rows(bricks[i]), placeOf(i));
        });
        done += ready.value();
        job.report(static_cast<double>(done) / static_cast<double>(bricks.size()), "reading normals");
    }
    return {};
}

} // namespace isoslider::extract
