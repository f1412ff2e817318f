#include "core/topology/analysis/layer_window.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/grid/classification.h"
#include "core/grid/scalar_type.h"

namespace isoslider::topology {

template <class Sample>
void LayerWindow<Sample>::prepare() {
    findStars();
    findFlatRows();
    const std::int64_t planes = zEnd + 1 - firstPlane;
    higher.find(samples.data(), dims, planes, false, static_cast<std::int64_t>(samples.size()) > planes * planeStep());
}

template <class Sample>
void LayerWindow<Sample>::findStars() {
    stars.resize(static_cast<std::size_t>(points()));
    if (std::any_of(samples.begin(), samples.end(), [](Sample s) { return isMissing(s); }))
        findStarsWithMissing();
    else
        findStarsOfBox();
}

template <class Sample>
void LayerWindow<Sample>::findStarsOfBox() {
    // A side of the star sticks out of the grid at its ends.
    const auto inside = [this](std::size_t axis, std::int64_t at) {
        unsigned star = kWholeStar;
        if (at == 0)
            star &= kStarSides[2 * axis + 1];
        if (at + 1 == dims[axis])
            star &= kStarSides[2 * axis];
        return static_cast<CellStar>(star);
    };
    auto out = stars.begin();
    for (std::int64_t z = zBegin; z <= zEnd; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y, out += dims[0]) {
            const auto row = static_cast<CellStar>(inside(2, z) & inside(1, y));
            std::fill_n(out, dims[0], row);
            out[0] = static_cast<CellStar>(row & inside(0, 0));
            out[dims[0] - 1] = static_cast<CellStar>(out[dims[0] - 1] & inside(0, dims[0] - 1));
        }
}

template <class Sample>
void LayerWindow<Sample>::findStarsWithMissing() {
    const std::int64_t nx = dims[0], ny = dims[1], step = planeStep();
    const std::int64_t planes = static_cast<std::int64_t>(samples.size()) / step;
    // A plane of cells at a time adds its bits to the points below and above.
    std::fill(stars.begin(), stars.end(), CellStar{0});
    std::vector<std::uint8_t> isComplete(static_cast<std::size_t>(step));
    for (std::int64_t plane = 0; plane + 1 < planes; ++plane) {
        const Sample* const low = samples.data() + step * plane;
        for (std::int64_t y = 0; y + 1 < ny; ++y)
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                bool isWhole = true;
                for (std::size_t c = 0; c < 8; ++c)
                    isWhole = isWhole && !isMissing(low[x + (c & 1) + nx * (y + (c >> 1 & 1)) + step * (c >> 2)]);
                isComplete[static_cast<std::size_t>(x + nx * y)] = isWhole;
            }
        for (std::int64_t dz = 0; dz < 2; ++dz) {
            const std::int64_t z = firstPlane + plane + dz;
            if (z < zBegin || z > zEnd)
                continue;
            for (std::int64_t y = 0; y + 1 < ny; ++y)
                for (std::int64_t x = 0; x + 1 < nx; ++x)
                    if (isComplete[static_cast<std::size_t>(x + nx * y)] != 0)
                        for (std::int64_t c = 0; c < 4; ++c) // the cell lies on the far side of its near corners
                            stars[static_cast<std::size_t>(x + (c & 1) + nx * (y + (c >> 1)) + step * (z - zBegin))] |=
                                static_cast<CellStar>(1u << (7 - (c | dz << 2)));
        }
    }
}

template <class Sample>
void LayerWindow<Sample>::findFlatRows() {
    const std::int64_t nx = dims[0], ny = dims[1];
    const std::int64_t rows = static_cast<std::int64_t>(samples.size()) / nx;
    const auto rowAt = [&](std::int64_t row) { return samples.data() + nx * row; };
    std::vector<std::uint8_t> isConstant(static_cast<std::size_t>(rows));
    for (std::int64_t row = 0; row < rows; ++row)
        isConstant[static_cast<std::size_t>(row)] =
            !isMissing(*rowAt(row)) &&
            std::memcmp(rowAt(row), rowAt(row) + 1, static_cast<std::size_t>(nx - 1) * sizeof(Sample)) == 0;
    const std::int64_t firstRow = ny * (zBegin - firstPlane);
    flatRows.resize(static_cast<std::size_t>(ny * (zEnd - zBegin + 1)));
    for (std::size_t i = 0; i < flatRows.size(); ++i) {
        const std::int64_t row = firstRow + static_cast<std::int64_t>(i), y = row % ny;
        bool isFlat = true;
        for (const std::int64_t plane : {-ny, std::int64_t{0}, ny})
            for (std::int64_t dy = y > 0 ? -1 : 0; dy <= (y + 1 < ny ? 1 : 0); ++dy) {
                const std::int64_t other = row + plane + dy;
                isFlat = isFlat && (other < 0 || other >= rows ||
                                    (isConstant[static_cast<std::size_t>(other)] != 0 && *rowAt(other) == *rowAt(row)));
            }
        flatRows[i] = isFlat;
    }
}

#define ISO_INSTANTIATE(Sample, Name) template void LayerWindow<Sample>::prepare();
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
