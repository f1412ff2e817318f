#include "core/topology/analysis/higher_neighbours.h"

#include <algorithm>
#include <type_traits>

#include "core/grid/scalar_type.h"

// Compiled once for each instruction set; the best one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/topology/analysis/higher_neighbours.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ISO_HIGHER_NEIGHBOURS
#define ISO_HIGHER_NEIGHBOURS
namespace isoslider::topology {

inline constexpr std::array<std::size_t, 4> kPartStart{0, 6, 14, 18};

template <class Sample>
inline void findHigherAt(const Sample* row, const HigherNeighbours::Row& of, std::int64_t x) {
    for (std::size_t part = 0; part < 3; ++part) {
        unsigned bits = 0;
        for (std::size_t n = kPartStart[part]; n < kPartStart[part + 1]; ++n) {
            const Sample other = row[x + of.steps[n]];
            bits |= ((of.steps[n] > 0 ? other >= row[x] : other > row[x]) ? 1u : 0u) << (n - kPartStart[part]);
        }
        of.out[part][x] = static_cast<std::uint8_t>(bits);
    }
}

} // namespace isoslider::topology
#endif

HWY_BEFORE_NAMESPACE();
namespace isoslider::topology::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Sample>
HWY_INLINE void findHigher(const Sample* HWY_RESTRICT row, const HigherNeighbours::Row& of, std::int64_t from,
                           std::int64_t to) {
    const hn::ScalableTag<Sample> d;
    const hn::RebindToUnsigned<decltype(d)> bitsTag;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    if (to - from < lanes) {
        for (std::int64_t x = from; x < to; ++x)
            findHigherAt(row, of, x);
        return;
    }
    for (std::int64_t next = from; next < to; next += lanes) {
        const std::int64_t x = std::min(next, to - lanes); // the last ones twice
        const auto own = hn::LoadU(d, row + x);
        for (std::size_t part = 0; part < 3; ++part) {
            auto bits = hn::Zero(bitsTag);
            for (std::size_t n = kPartStart[part]; n < kPartStart[part + 1]; ++n) {
                const auto other = hn::LoadU(d, row + x + of.steps[n]);
                const auto bit =
                    hn::Set(bitsTag, static_cast<hn::TFromD<decltype(bitsTag)>>(1u << (n - kPartStart[part])));
                const auto isLower = of.steps[n] > 0 ? hn::Lt(other, own) : hn::Not(hn::Lt(own, other));
                bits = hn::Or(bits, hn::AndNot(hn::VecFromMask(bitsTag, hn::RebindMask(bitsTag, isLower)), bit));
            }
            if constexpr (sizeof(Sample) == 1)
                hn::StoreU(bits, bytes, of.out[part] + x);
            else
                hn::StoreU(hn::TruncateTo(bytes, bits), bytes, of.out[part] + x);
        }
    }
}

#define ISO_KERNEL(Sample, Name) \
    void findHigher##Name(const Sample* row, const HigherNeighbours::Row& of, std::int64_t from, std::int64_t to) { \
        findHigher(row, of, from, to); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_KERNEL)
#undef ISO_KERNEL

} // namespace isoslider::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isoslider::topology {

#define ISO_EXPORT(Sample, Name) \
    HWY_EXPORT(findHigher##Name); \
    static void findInRow(const Sample* row, const HigherNeighbours::Row& of, std::int64_t from, std::int64_t to) { \
        HWY_DYNAMIC_DISPATCH(findHigher##Name)(row, of, from, to); \
    }
ISO_FOR_EACH_SAMPLE_TYPE(ISO_EXPORT)
#undef ISO_EXPORT

template <class Sample>
void HigherNeighbours::find(const Sample* samples, const GridDims& dims, std::int64_t planes, bool hasPlaneBefore,
                            bool hasPlaneAfter) {
    const std::int64_t nx = dims[0], plane = nx * dims[1];
    for (auto& part : parts_)
        part.resize(static_cast<std::size_t>(plane * planes));
    // A step out of what is there leads nowhere.
    std::array<std::ptrdiff_t, 6> steps{};
    const auto rowOf = [&](std::int64_t start) {
        Row row{};
        std::copy(steps.begin(), steps.end(), row.steps.begin());
        for (std::size_t f = 0; f < kFacePairs.size(); ++f) {
            const std::ptrdiff_t first = steps[kFacePairs[f][0]], second = steps[kFacePairs[f][1]];
            row.steps[kEdgeNeighbours + f] = first != 0 && second != 0 ? first + second : 0;
        }
        for (std::size_t part = 0; part < 3; ++part)
            row.out[part] = parts_[part].data() + start;
        return row;
    };
    for (std::int64_t z = 0; z < planes; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y) {
            const std::int64_t start = plane * z + nx * y;
            const Sample* const row = samples + start;
            steps = {0,
                     1,
                     y > 0 ? -nx : 0,
                     y + 1 < dims[1] ? nx : 0,
                     z > 0 || hasPlaneBefore ? -plane : 0,
                     z + 1 < planes || hasPlaneAfter ? plane : 0};
            if (nx == 1)
                steps[1] = 0;
            findHigherAt(row, rowOf(start), 0);
            if (nx == 1)
                continue;
            steps[0] = -1;
            findInRow(row, rowOf(start), 1, nx - 1);
            steps[1] = 0;
            findHigherAt(row, rowOf(start), nx - 1);
        }
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void HigherNeighbours::find(const Sample*, const GridDims&, std::int64_t, bool, bool);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
#endif
