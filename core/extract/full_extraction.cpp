#include "core/extract/full_extraction.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <mutex>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/cell/cell_states.h"
#include "core/extract/edge_interpolation.h"
#include "core/extract/inner_vertices.h"
#include "core/extract/vertex_fans.h"
#include "core/grid/classification.h"
#include "core/grid/edge_cells.h"
#include "core/grid/gradient.h"
#include "core/grid/normal_codec.h"

namespace isoslider::extract {
namespace {

// Two passes over z planes. The first counts each plane's vertices and triangles; prefix sums give
// every plane its place in the output. The second fills it. Each task takes a run of planes and
// carries the previous plane's signs and vertex numbers along, so a sample is read about twice. Inner
// vertices come after all others; they are placed last, from the vertices around them.

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

enum PointFlag : std::uint8_t { kAbove = 1, kMissing = 2 };

template <class Sample>
class Extractor {
    using Live = LiveOf<Sample>;

public:
    Extractor(const ScalarGrid& grid, double isovalue, const JobControl& job)
        : view_{grid.values<Sample>().data(), grid.dims()},
          isovalue_(isovalue),
          job_(job),
          inverseSpacing_(inverseSpacingOf(grid.geometry())) {
        nx_ = view_.dims[0];
        ny_ = view_.dims[1];
        nz_ = view_.dims[2];
    }

    Status run(SurfaceMesh& mesh) {
        if (nx_ < 2 || ny_ < 2 || nz_ < 2)
            return {};
        findMissingPlanes();
        vertexBegin_.assign(static_cast<std::size_t>(nz_) + 1, 0);
        triangleBegin_.assign(static_cast<std::size_t>(nz_) + 1, 0);
        innerBegin_.assign(static_cast<std::size_t>(nz_) + 1, 0);
        forPlanes(0.0, [this](std::int64_t z0, std::int64_t z1) { countPlanes(z0, z1); });
        if (job_.isStopRequested())
            return cancelledError();
        const std::uint64_t vertices = prefixSum(vertexBegin_);
        const std::uint64_t triangles = prefixSum(triangleBegin_);
        const std::uint64_t inner = prefixSum(innerBegin_);
        if (vertices + inner >= kNoVertex)
            return makeError(ErrorCode::OutOfSpace, "the surface has more than 2^32 vertices");
        for (std::uint64_t& begin : innerBegin_)
            begin += vertices;
        mesh.positions.resize(vertices + inner);
        mesh.normals.resize(vertices + inner);
        mesh.edgeIds.resize(vertices);
        mesh.triangles.resize(3 * triangles);
        forPlanes(0.5, [this, &mesh](std::int64_t z0, std::int64_t z1) { fillPlanes(z0, z1, mesh); });
        if (job_.isStopRequested())
            return cancelledError();
        placeInnerVertices(mesh);
        if (std::find(planeHasMissing_.begin(), planeHasMissing_.end(), 1) != planeHasMissing_.end())
            ISO_TRY(splitVerticesOfSeveralFans(mesh, job_));
        if (job_.isStopRequested())
            return cancelledError();
        return {};
    }

private:
    // One z plane: flags per point, and the vertex numbers of the x, y and z edges that start there.
    struct Plane {
        std::vector<std::uint8_t> flags;
        std::vector<std::uint32_t> edgeVertex[3];
    };

    // A cell with inner vertices, until all edges have their vertices.
    struct InnerCell {
        std::array<std::int64_t, 3> origin;
        cell::StateId state;
        std::uint32_t firstInner;
        std::array<std::uint32_t, 12> edgeVertices;
    };

    template <class Function>
    void forPlanes(double from, const Function& function) { // from where on its half of the progress goes
        constexpr std::int64_t kPlanesPerTask = 8;
        const std::int64_t tasks = (nz_ + kPlanesPerTask - 1) / kPlanesPerTask;
        std::int64_t finished = 0;
        std::mutex progressMutex;
        tbb::parallel_for(std::int64_t{0}, tasks, [&](std::int64_t task) {
            if (job_.isStopRequested())
                return;
            function(task * kPlanesPerTask, std::min(nz_, (task + 1) * kPlanesPerTask));
            const std::scoped_lock lock(progressMutex);
            job_.report(from + 0.5 * static_cast<double>(++finished) / static_cast<double>(tasks), "extracting");
        });
    }

    static std::uint64_t prefixSum(std::vector<std::uint64_t>& counts) {
        std::uint64_t sum = 0;
        for (std::uint64_t& count : counts)
            sum += std::exchange(count, sum);
        return sum;
    }

    void classify(std::int64_t z, Plane& plane) const {
        const Sample* samples = view_.samples + view_.offset(0, 0, z);
        plane.flags.resize(static_cast<std::size_t>(nx_ * ny_));
        for (std::size_t i = 0; i < plane.flags.size(); ++i)
            plane.flags[i] = static_cast<std::uint8_t>((isAbove(samples[i], isovalue_) ? kAbove : 0) |
                                                       (isMissing(samples[i]) ? kMissing : 0));
    }

    // Flags of the eight corners of cell (x, y, z): low byte signs, high byte missing.
    int cornerFlags(const Plane& lower, const Plane& upper, std::size_t i) const {
        const std::size_t row = static_cast<std::size_t>(nx_);
        const std::uint8_t f[8] = {lower.flags[i], lower.flags[i + 1], lower.flags[i + row], lower.flags[i + row + 1],
                                   upper.flags[i], upper.flags[i + 1], upper.flags[i + row], upper.flags[i + row + 1]};
        int signs = 0;
        int missing = 0;
        for (int c = 0; c < 8; ++c) {
            signs |= (f[c] & kAbove) << c;
            missing |= (f[c] & kMissing) << c;
        }
        return missing ? -1 : signs;
    }

    // Beside missing values an edge counts only if one of its four cells is valid: vertices that no
    // triangle could use do not exist.
    bool hasValidCellAt(std::int64_t x, std::int64_t y, std::int64_t z, int axis) const {
        return hasValidCell(x, y, z, axis, [this](auto... cell) { return view_.isCellValid(cell...); });
    }

    bool isActive(std::uint8_t a, std::uint8_t b, bool checksMissing, std::int64_t x, std::int64_t y, std::int64_t z,
                  int axis) const {
        if (!((a ^ b) & kAbove))
            return false;
        return !checksMissing || (!((a | b) & kMissing) && hasValidCellAt(x, y, z, axis));
    }

    // Calls visit(x, y, axis) for each active edge that starts in plane z, in (y, x, axis) order.
    template <class Visit>
    void forActiveEdges(std::int64_t z, const Plane& plane, const Plane* upper, const Visit& visit) const {
        // A missing sample in a neighbouring plane matters too, two planes away at most.
        const bool checksMissing = std::is_floating_point_v<Sample> && hasMissingNear(z);
        const std::size_t row = static_cast<std::size_t>(nx_);
        for (std::int64_t y = 0; y < ny_; ++y)
            for (std::int64_t x = 0; x < nx_; ++x) {
                const std::size_t i = static_cast<std::size_t>(x) + row * static_cast<std::size_t>(y);
                const std::uint8_t here = plane.flags[i];
                if (x + 1 < nx_ && isActive(here, plane.flags[i + 1], checksMissing, x, y, z, 0))
                    visit(x, y, 0);
                if (y + 1 < ny_ && isActive(here, plane.flags[i + row], checksMissing, x, y, z, 1))
                    visit(x, y, 1);
                if (upper && isActive(here, upper->flags[i], checksMissing, x, y, z, 2))
                    visit(x, y, 2);
            }
    }

    bool hasMissingNear(std::int64_t z) const {
        for (std::int64_t k = std::max<std::int64_t>(0, z - 1); k <= std::min(nz_ - 1, z + 1); ++k)
            if (planeHasMissing_[static_cast<std::size_t>(k)])
                return true;
        return false;
    }

    void countPlanes(std::int64_t z0, std::int64_t z1) {
        Plane planes[2];
        classify(z0, planes[z0 & 1]);
        for (std::int64_t z = z0; z < z1; ++z) {
            const Plane& lower = planes[z & 1];
            Plane* upper = nullptr;
            if (z + 1 < nz_) {
                upper = &planes[(z + 1) & 1];
                classify(z + 1, *upper);
            }
            std::uint64_t vertices = 0;
            forActiveEdges(z, lower, upper, [&](std::int64_t, std::int64_t, int) { ++vertices; });
            vertexBegin_[static_cast<std::size_t>(z)] = vertices;
            if (upper)
                countCells(z, lower, *upper);
        }
    }

    void countCells(std::int64_t z, const Plane& lower, const Plane& upper) {
        std::uint64_t triangles = 0, inner = 0;
        forActiveCells(z, lower, upper, [&](std::int64_t, std::int64_t, cell::StateId state) {
            triangles += states_[state].triangleCount;
            inner += states_[state].innerVertices;
        });
        triangleBegin_[static_cast<std::size_t>(z)] = triangles;
        innerBegin_[static_cast<std::size_t>(z)] = inner;
    }

    cell::CornerScalars scalarsOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
        cell::CornerScalars scalars;
        for (std::size_t c = 0; c < 8; ++c) {
            const auto corner = static_cast<std::int64_t>(c);
            scalars[c] = static_cast<double>(
                view_.samples[view_.offset(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2))]);
        }
        return scalars;
    }

    // Calls visit(x, y, state) for the active cells between plane z and the next.
    template <class Visit>
    void forActiveCells(std::int64_t z, const Plane& lower, const Plane& upper, const Visit& visit) const {
        for (std::int64_t y = 0; y + 1 < ny_; ++y)
            for (std::int64_t x = 0; x + 1 < nx_; ++x) {
                const int flags = cornerFlags(lower, upper, static_cast<std::size_t>(x + nx_ * y));
                if (flags <= 0 || flags >= 255)
                    continue;
                const auto signs = static_cast<std::uint8_t>(flags);
                visit(x, y,
                      cell::isAmbiguous(signs) ? cell::resolveCell(signs, scalarsOf(x, y, z), isovalue_).state
                                               : cell::StateId{signs});
            }
    }

    void fillPlanes(std::int64_t z0, std::int64_t z1, SurfaceMesh& mesh) {
        Plane planes[3];
        const auto prepare = [&](std::int64_t z) {
            Plane& plane = planes[z % 3];
            for (auto& numbers : plane.edgeVertex)
                numbers.assign(static_cast<std::size_t>(nx_ * ny_), kNoVertex);
        };
        const auto number = [&](std::int64_t z, bool writes) {
            Plane& plane = planes[z % 3];
            const Plane* upper = z + 1 < nz_ ? &planes[(z + 1) % 3] : nullptr;
            std::uint64_t next = vertexBegin_[static_cast<std::size_t>(z)];
            forActiveEdges(z, plane, upper, [&](std::int64_t x, std::int64_t y, int axis) {
                plane.edgeVertex[axis][static_cast<std::size_t>(x + nx_ * y)] = static_cast<std::uint32_t>(next);
                if (writes)
                    writeVertex(x, y, z, axis, next, mesh);
                ++next;
            });
        };
        classify(z0, planes[z0 % 3]);
        if (z0 + 1 < nz_)
            classify(z0 + 1, planes[(z0 + 1) % 3]);
        prepare(z0);
        number(z0, true);
        for (std::int64_t z = z0; z < z1 && z + 1 < nz_; ++z) {
            if (z + 2 < nz_)
                classify(z + 2, planes[(z + 2) % 3]);
            prepare(z + 1);
            number(z + 1, z + 1 < z1);
            std::uint32_t* out = mesh.triangles.data() + 3 * triangleBegin_[static_cast<std::size_t>(z)];
            writeTriangles(z, planes[z % 3], planes[(z + 1) % 3], out);
        }
    }

    void writeTriangles(std::int64_t z, const Plane& lower, const Plane& upper, std::uint32_t* out) {
        const std::size_t row = static_cast<std::size_t>(nx_);
        auto nextInner = static_cast<std::uint32_t>(innerBegin_[static_cast<std::size_t>(z)]);
        std::vector<InnerCell>& innerCells = innerCells_.local();
        forActiveCells(z, lower, upper, [&](std::int64_t x, std::int64_t y, cell::StateId stateId) {
            const cell::CellState& state = states_[stateId];
            const std::size_t i = static_cast<std::size_t>(x + nx_ * y);
            const std::array<std::uint32_t, 12> vertices = {
                lower.edgeVertex[0][i],       lower.edgeVertex[0][i + row], upper.edgeVertex[0][i],
                upper.edgeVertex[0][i + row], lower.edgeVertex[1][i],       lower.edgeVertex[1][i + 1],
                upper.edgeVertex[1][i],       upper.edgeVertex[1][i + 1],   lower.edgeVertex[2][i],
                lower.edgeVertex[2][i + 1],   lower.edgeVertex[2][i + row], lower.edgeVertex[2][i + row + 1]};
            for (const std::uint8_t vertex : state.triangles)
                *out++ = vertex < cell::kInnerVertex ? vertices[vertex] : nextInner + vertex - cell::kInnerVertex;
            if (state.innerVertices > 0) {
                innerCells.push_back({{x, y, z}, stateId, nextInner, vertices});
                nextInner += state.innerVertices;
            }
        });
    }

    void placeInnerVertices(SurfaceMesh& mesh) {
        for (const std::vector<InnerCell>& cells : innerCells_)
            tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
                if (job_.isStopRequested())
                    return;
                const InnerCell& inner = cells[i];
                InnerVertexCell placed;
                placed.state = &states_[inner.state];
                placed.origin = inner.origin;
                for (unsigned mask = cell::activeEdges(placed.state->signs); mask != 0; mask &= mask - 1) {
                    const auto e = static_cast<std::size_t>(std::countr_zero(mask));
                    placed.edgePositions[e] = mesh.positions[inner.edgeVertices[e]];
                    placed.edgeNormals[e] = mesh.normals[inner.edgeVertices[e]];
                }
                placed.scalars = scalarsOf(inner.origin[0], inner.origin[1], inner.origin[2]);
                std::array<InnerVertex, cell::kMaxInnerVertices> vertices;
                extract::placeInnerVertices(placed, isovalue_, inverseSpacing_, vertices.data());
                for (std::size_t k = 0; k < placed.state->innerVertices; ++k) {
                    mesh.positions[inner.firstInner + k] = positionOf(vertices[k], inner.origin);
                    mesh.normals[inner.firstInner + k] = decodeNormal(vertices[k].normal);
                }
            });
    }

    void writeVertex(std::int64_t x, std::int64_t y, std::int64_t z, int axis, std::uint64_t index,
                     SurfaceMesh& mesh) const {
        const std::ptrdiff_t here = view_.offset(x, y, z);
        const Live s1 = static_cast<Live>(view_.samples[here]);
        const Live s2 = static_cast<Live>(view_.samples[here + view_.stride(axis)]);
        const float t = static_cast<float>(edgeFraction<Live>(s1, s2, static_cast<Live>(isovalue_)));
        glm::vec3 position(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        position[axis] += t;
        std::int64_t far[3] = {x, y, z};
        ++far[axis];
        mesh.positions[index] = position;
        mesh.normals[index] = edgeNormal(normalAt(x, y, z), normalAt(far[0], far[1], far[2]), t, axis, s1 < s2);
        mesh.edgeIds[index] = 4 * static_cast<EdgeId>(here) + static_cast<EdgeId>(axis);
    }

    // Quantised as an index stores it: both give the same surface to the last bit.
    NormalCode normalAt(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return normalOfGradient(gradientAt(view_, x, y, z, inverseSpacing_));
    }

    void findMissingPlanes() {
        planeHasMissing_.assign(static_cast<std::size_t>(nz_), 0);
        if constexpr (std::is_floating_point_v<Sample>) {
            tbb::parallel_for(std::int64_t{0}, nz_, [this](std::int64_t z) {
                if (job_.isStopRequested())
                    return;
                const Sample* samples = view_.samples + view_.offset(0, 0, z);
                const std::int64_t count = nx_ * ny_;
                bool missing = false;
                for (std::int64_t i = 0; i < count; ++i)
                    missing |= isMissing(samples[i]);
                planeHasMissing_[static_cast<std::size_t>(z)] = missing;
            });
        }
    }

    SampleView<Sample> view_;
    std::int64_t nx_ = 0, ny_ = 0, nz_ = 0;
    double isovalue_;
    const JobControl& job_;
    glm::vec3 inverseSpacing_{1.0f};
    std::vector<std::uint8_t> planeHasMissing_;
    std::vector<std::uint64_t> vertexBegin_;
    std::vector<std::uint64_t> triangleBegin_;
    std::vector<std::uint64_t> innerBegin_;
    std::span<const cell::CellState> states_ = cell::cellStates();
    tbb::enumerable_thread_specific<std::vector<InnerCell>> innerCells_;
};

} // namespace

Result<SurfaceMesh> extractFull(const ScalarGrid& grid, double isovalue, const JobControl& job) {
    SurfaceMesh mesh;
    mesh.geometry = grid.geometry();
    mesh.isovalue = isovalue;
    const Status status = visitScalarType(grid.type(), [&](auto sample) {
        Extractor<decltype(sample)> extractor(grid, isovalue, job);
        return extractor.run(mesh);
    });
    ISO_TRY(status);
    return mesh;
}

} // namespace isoslider::extract
