#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::bench {

/// A volume and the isovalue around which slides are laid.
struct BenchVolume {
    std::string name;
    std::shared_ptr<const ScalarGrid> grid;
    double min = 0.0; ///< of the finite samples
    double max = 0.0;
    double centre = 0.0; ///< see centreIsovalue()
    bool hasMissing = false;

    std::uint64_t points() const { return static_cast<std::uint64_t>(pointCount(grid->dims())); }
};

/// Makes or reads a volume. `spec` is one of
/// - shellN: distance from a sphere, u16, N^3 (the Spherical Shell of the paper's Table 1 for N = 256);
/// - whiteN: see makeWhiteNoise(), f32;
/// - mlN: the test signal of Marschner and Lobb, f32;
/// - ctN: see makeNoisyScan(), i16;
/// - noiseN: four octaves of value noise, f32;
/// - bluntfin: the sample volume of that name, resampled to 256^3, f32 with missing values;
/// - cranium, jmjd2da: 256 x 256 x 108 i16 and 137 x 152 x 147 f32, of ISOSLIDER_SHARED_DIR (NotFound without it);
/// - PATH:nx:ny:nz:TYPE[:skipBytes]: a headerless little-endian file;
/// - PATH: any volume that has a reader.
/// Errors: InvalidArgument (nothing of the kind) and those of the readers.
Result<BenchVolume> loadWorkload(const std::string& spec, const std::filesystem::path& resourcesDir);

/// Of ISOSLIDER_SHARED_DIR: may be absent without anything being wrong.
bool isFurtherVolume(const std::string& spec);

/// Generated volumes: samples x fastest. REQUIRES: size >= 2.
ScalarGrid makeShell(int size);
ScalarGrid makeMarschnerLobb(int size);
ScalarGrid makeNoise(int size);
/// size x size x 275/512 size: smooth shapes with noise on every sample, as a CT of a body. One active cell in four or
/// so is ambiguous.
ScalarGrid makeNoisyScan(int size);
/// Every sample on its own: half of the active cells are ambiguous, as in no real volume.
ScalarGrid makeWhiteNoise(int size);

/// Of 401 isovalues evenly spaced over the middle 40 % of [min, max], the first with the most active
/// edges. Edges with a missing end do not count.
double centreIsovalue(const ScalarGrid& grid, double min, double max);

/// steps + 1 isovalues. The first is where the surface starts; each further one is `percent` % of the
/// range away from the one before. The slide is centred on the centre isovalue, begins no lower than
/// 2 % of the range, and turns round where it would leave [2 %, 98 %]. No isovalue of an integer volume
/// falls on a sample value.
std::vector<double> slide(const BenchVolume& volume, double percent, int steps);

} // namespace isoslider::bench
