#include "core/index/validation/fault_list.h"

#include <algorithm>
#include <sstream>

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
        next() << textOf(*isovalues);
    if (box)
        next() << textOf(*box);
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
    return isovaluesOf(reader_.info().type, firstKey, lastKey);
}

PointBox FaultList::boxOfBricks(std::uint64_t first, std::uint64_t last) const {
    return index::boxOfBricks(reader_.grid(), BrickIndex(first), BrickIndex(last));
}

PointBox FaultList::boxOfChunks(std::uint64_t first, std::uint64_t last) const {
    return index::boxOfChunks(reader_.info().geometry.dims, ChunkIndex(first), ChunkIndex(last));
}

Status addOrPassOn(FaultList& faults, const Error& error, IndexFault fault) {
    if (error.code != ErrorCode::Corruption)
        return error;
    fault.problem = problemOf(error.message);
    faults.add(std::move(fault));
    return {};
}

} // namespace isoslider::index
