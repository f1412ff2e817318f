#include "core/index/format/totals_page.h"

#include <algorithm>

#include "core/index/format/byte_planes.h"
#include "core/index/format/zigzag.h"

namespace isoslider::index {
namespace {

constexpr std::size_t kHeaderBytes = sizeof(std::uint32_t);
constexpr int kPlanesOfColumn = sizeof(std::uint32_t), kPlanes = 2 * kPlanesOfColumn;

} // namespace

void combineTotals(std::vector<BrickTotal>& totals) {
    std::sort(totals.begin(), totals.end(), [](const BrickTotal& a, const BrickTotal& b) { return a.brick < b.brick; });
    auto out = totals.begin();
    for (auto first = totals.begin(); first != totals.end();) {
        const BrickIndex brick = first->brick;
        std::int64_t sum = 0;
        for (; first != totals.end() && first->brick == brick; ++first)
            sum += first->count;
        if (sum != 0)
            *out++ = {brick, static_cast<std::int32_t>(std::clamp<std::int64_t>(sum, -kMostOfTotal, kMostOfTotal))};
    }
    totals.erase(out, totals.end());
}

std::vector<std::byte> encodeTotals(std::span<const BrickTotal> totals) {
    ISO_CHECK(!totals.empty() && totals.size() <= kMaxPageTotals);
    thread_local std::vector<std::uint32_t> bricks, counts;
    bricks.clear();
    counts.clear();
    std::uint32_t previous = 0;
    for (const BrickTotal& total : totals) {
        const auto brick = static_cast<std::uint32_t>(total.brick.number());
        bricks.push_back(brick - previous);
        counts.push_back(zigzag(static_cast<std::uint32_t>(total.count)));
        previous = brick;
    }
    std::vector<std::byte> bytes;
    ByteWriter(bytes).put<std::uint32_t>(static_cast<std::uint32_t>(totals.size()));
    PlaneWriter writer(bytes, kPlanes);
    writer.addColumn(bricks, kPlanesOfColumn);
    writer.addColumn(counts, kPlanesOfColumn);
    ISO_CHECK(writer.isComplete());
    return bytes;
}

Status decodeTotals(std::span<const std::byte> bytes, const BrickGrid& grid, std::vector<BrickTotal>& totals,
                    const std::string& path) {
    PlaneReader reader(bytes, path);
    if (bytes.size() < kHeaderBytes)
        return reader.corrupt("header is cut off");
    const std::size_t count = ByteReader(bytes.first(kHeaderBytes)).get<std::uint32_t>();
    if (count == 0 || count > kMaxPageTotals)
        return reader.corrupt("number of totals");
    thread_local std::vector<std::uint32_t> bricks, counts;
    ISO_TRY(reader.beginPlanes(kHeaderBytes, kPlanes));
    ISO_TRY(reader.readColumn(bricks, count, kPlanesOfColumn));
    ISO_TRY(reader.readColumn(counts, count, kPlanesOfColumn));
    if (!reader.isAtEnd())
        return reader.corrupt("bytes after the last plane");
    totals.clear();
    std::uint64_t brick = 0;
    for (std::size_t i = 0; i < count; ++i) {
        brick += bricks[i];
        if (brick >= grid.brickCount() || (i > 0 && bricks[i] == 0))
            return reader.corrupt("brick of a total");
        const auto total = static_cast<std::int32_t>(unzigzag(counts[i]));
        if (total == 0 || total < -kMostOfTotal || total > kMostOfTotal)
            return reader.corrupt("total");
        totals.push_back({BrickIndex(static_cast<std::uint32_t>(brick)), total});
    }
    return {};
}

} // namespace isoslider::index
