#pragma once

// C++17: VTK 9.1's thread headers do not compile as C++20, so nothing of the project is included here.

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace isoslider::bench {

/// Sample types as VTK takes them.
enum class PeerSample { U8, I8, U16, I16, I32, F32, F64 };

/// A volume in memory, x fastest; not copied.
struct PeerVolume {
    const void* samples = nullptr;
    PeerSample type = PeerSample::U8;
    std::array<int, 3> dims{0, 0, 0};
};

/// vtkFlyingEdges3D over a volume: extracts afresh at every isovalue, with normals, without gradients
/// and scalars.
class FlyingEdges {
public:
    struct Surface {
        std::uint64_t vertices = 0;
        std::uint64_t triangles = 0;
        bool hasNormals = false;
    };

    /// `backend`: "STDThread", "TBB" or "Sequential". The volume must outlive the object.
    FlyingEdges(const PeerVolume& volume, int threads, const std::string& backend);
    ~FlyingEdges();

    Surface extract(double isovalue);
    /// The backend in use: VTK may have been built without the one asked for.
    std::string backend() const;

private:
    struct Filter;
    std::unique_ptr<Filter> filter_;
};

} // namespace isoslider::bench
