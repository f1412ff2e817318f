#include "core/index/validation/fault_list.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/grid/scalar_key.h"
#include "core/index/format/chunk_grid.h"

namespace isoslider::index {

std::string IndexFault::line() const {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << part << ' ' << problem;
    const char* separator = " (";
    const auto next = [&]() -> std::ostream& {
        text << separator;
        separator = "; ";
        return text;
    };
    if (offset)
        next() << "at byte " << *offset;
    if (isovalues)
        next() << "isovalues " << (*isovalues)[0] << " to " << (*isovalues)[1];
    if (box)
        next() << "grid points " << box->first[0] << ',' << box->first[1] << ',' << box->first[2] << " to "
               << box->last[0] << ',' << box->last[1] << ',' << box->last[2];
    text << (offset || isovalues || box ? ")" : "");
    return text.str();
}

void FaultList::add(IndexFault fault) {
    const std::lock_guard lock(mutex_);
    ++count_;
    if (faults_.size() < most_)
        faults_.push_back(std::move(fault));
}

std::vector<IndexFault> FaultList::take() {
    // Threads come in any order.
    std::stable_sort(faults_.begin(), faults_.end(), [](const IndexFault& a, const IndexFault& b) {
        return a.offset.value_or(0) < b.offset.value_or(0);
    });
    return std::move(faults_);
}

std::optional<std::array<double, 2>> FaultList::isovalues(std::uint64_t firstKey, std::uint64_t lastKey) const {
    return visitScalarType(reader_.info().type, [&](auto sample) -> std::optional<std::array<double, 2>> {
        using Sample = decltype(sample);
        const auto valueOf = [](std::uint64_t key) {
            return static_cast<double>(sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(key)));
        };
        const std::array<double, 2> range{valueOf(firstKey), valueOf(lastKey)};
        if (!std::isfinite(range[0]) || !std::isfinite(range[1]))
            return std::nullopt; // keys that no sample has
        return range;
    });
}

IndexFault::Box FaultList::boxOfBricks(std::uint64_t first, std::uint64_t last) const {
    const BrickGrid& grid = reader_.grid();
    auto begin = grid.brickCoords(BrickIndex(first)), end = grid.brickCoords(BrickIndex(last));
    // Whole rows where there are several, whole layers likewise.
    if (begin[2] != end[2]) {
        begin[1] = 0;
        end[1] = grid.bricks()[1] - 1;
    }
    if (begin[2] != end[2] || begin[1] != end[1]) {
        begin[0] = 0;
        end[0] = grid.bricks()[0] - 1;
    }
    IndexFault::Box box{};
    for (std::size_t a = 0; a < 3; ++a) {
        box.first[a] = begin[a] * kBrickSide;
        box.last[a] = std::min(grid.dims()[a], (end[a] + 1) * kBrickSide) - 1;
    }
    return box;
}

IndexFault::Box FaultList::boxOfChunk(std::uint64_t chunk) const {
    const ChunkGrid chunks(reader_.info().geometry.dims);
    const auto at = chunks.chunkCoords(ChunkIndex(chunk));
    const ChunkExtent extent = chunks.extent(ChunkIndex(chunk));
    IndexFault::Box box{};
    for (std::size_t a = 0; a < 3; ++a) {
        box.first[a] = at[a] * kChunkSide;
        box.last[a] = box.first[a] + extent[a] - 1;
    }
    return box;
}

std::string faultText(const std::string& message) {
    constexpr std::string_view kSubject = "index page "; // which the fault's part names
    return message.starts_with(kSubject) ? message.substr(kSubject.size()) : message;
}

Status addOrPassOn(FaultList& faults, const Error& error, IndexFault fault) {
    if (error.code != ErrorCode::Corruption)
        return error;
    fault.problem = faultText(error.message);
    faults.add(std::move(fault));
    return {};
}

} // namespace isoslider::index
