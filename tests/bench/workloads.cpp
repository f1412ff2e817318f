#include "tests/bench/workloads.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>
#include <random>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "core/grid/classification.h"
#include "core/volume_io/parsing/byte_stream.h"
#include "core/volume_io/sources/sample_volumes.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::bench {
namespace {

constexpr int kCentreCandidates = 401;

// Fills a box of square planes; plane(z, values) writes size^2 samples.
template <class Sample, class Plane>
ScalarGrid makePlanes(int size, int planes, ScalarType type, const Plane& plane) {
    GridGeometry geometry;
    geometry.dims = {size, size, planes};
    const std::size_t planePoints = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    std::vector<std::byte> bytes(planePoints * static_cast<std::size_t>(planes) * sizeof(Sample));
    auto* samples = reinterpret_cast<Sample*>(bytes.data());
    tbb::parallel_for(0, planes, [&](int z) { plane(z, samples + planePoints * static_cast<std::size_t>(z)); });
    return ScalarGrid(geometry, type, std::move(bytes));
}

template <class Sample, class Plane>
ScalarGrid makeCube(int size, ScalarType type, const Plane& plane) {
    return makePlanes<Sample>(size, size, type, plane);
}

// A number in [-1, 1) for a lattice point of an octave: a 32-bit mix of its coordinates.
float latticeValue(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t octave) {
    std::uint32_t hash = (x * 0x8da6b343u) ^ (y * 0xd8163841u) ^ (z * 0xcb1ab31fu) ^ ((octave + 1) * 0x9e3779b9u);
    hash = (hash ^ (hash >> 16)) * 0x7feb352du;
    hash = (hash ^ (hash >> 15)) * 0x846ca68bu;
    hash ^= hash >> 16;
    return static_cast<float>(hash >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

// Place of a grid coordinate on a lattice: cell and faded offset in it.
struct LatticePlace {
    LatticePlace(int coordinate, int cells, int size) {
        const float at = static_cast<float>(coordinate) * static_cast<float>(cells) / static_cast<float>(size);
        cell = static_cast<std::uint32_t>(at);
        weight = fade(at - static_cast<float>(cell));
    }
    std::uint32_t cell;
    float weight;
};

void addOctave(std::uint32_t octave, float amplitude, int size, int y, int z, float* row) {
    const int cells = 4 << octave;
    const LatticePlace py(y, cells, size), pz(z, cells, size);
    std::array<float, 4 * 8 + 1> column; // the lattice interpolated in y and z
    for (std::uint32_t i = 0; i <= static_cast<std::uint32_t>(cells); ++i) {
        const auto alongY = [&](std::uint32_t latticeZ) {
            return latticeValue(i, py.cell, latticeZ, octave) * (1 - py.weight) +
                   latticeValue(i, py.cell + 1, latticeZ, octave) * py.weight;
        };
        column[i] = alongY(pz.cell) * (1 - pz.weight) + alongY(pz.cell + 1) * pz.weight;
    }
    for (int x = 0; x < size; ++x) {
        const LatticePlace px(x, cells, size);
        row[x] += amplitude * (column[px.cell] + (column[px.cell + 1] - column[px.cell]) * px.weight);
    }
}

struct Range {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    bool hasMissing = false;
};

void findRange(BenchVolume& volume) {
    const auto joined = [](const Range& a, const Range& b) {
        return Range{std::min(a.min, b.min), std::max(a.max, b.max), a.hasMissing || b.hasMissing};
    };
    const Range range = volume.grid->visit([&](auto samples) {
        using Sample = std::remove_cv_t<typename decltype(samples)::element_type>;
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, samples.size(), std::size_t{1} << 18), Range{},
            [&](const tbb::blocked_range<std::size_t>& part, const Range& sofar) {
                Sample least = std::numeric_limits<Sample>::max(), greatest = std::numeric_limits<Sample>::lowest();
                bool hasMissing = false, hasFinite = false;
                for (std::size_t i = part.begin(); i < part.end(); ++i) {
                    if (isMissing(samples[i])) {
                        hasMissing = true;
                        continue;
                    }
                    hasFinite = true;
                    least = std::min(least, samples[i]);
                    greatest = std::max(greatest, samples[i]);
                }
                Range found;
                if (hasFinite)
                    found = {static_cast<double>(least), static_cast<double>(greatest)};
                found.hasMissing = hasMissing;
                return joined(sofar, found);
            },
            joined);
    });
    volume.hasMissing = range.hasMissing;
    if (range.min <= range.max) {
        volume.min = range.min;
        volume.max = range.max;
    }
}

// Active edges per candidate isovalue, as differences from one candidate to the next. An edge is active at
// isovalues in (lower sample, upper sample]: from the candidate after the lower one's place to the upper one's.
class CandidateCounts {
public:
    using Place = std::int16_t;
    static constexpr Place kMissing = -2;

    CandidateCounts(double first, double step) : first_(first), step_(step) {}

    /// The last candidate that is not above the sample; -1 below all.
    template <class Sample>
    Place placeOf(Sample sample) const {
        if (isMissing(sample))
            return kMissing;
        const double place = std::floor((static_cast<double>(sample) - first_) / step_);
        return static_cast<Place>(std::clamp(place, -1.0, kCentreCandidates - 1.0));
    }
    void addEdge(Place p, Place q) {
        if (p == q || p == kMissing || q == kMissing)
            return;
        ++differences_[static_cast<std::size_t>(std::min(p, q) + 1)];
        --differences_[static_cast<std::size_t>(std::max(p, q) + 1)];
    }
    void add(const CandidateCounts& other) {
        for (std::size_t i = 0; i < differences_.size(); ++i)
            differences_[i] += other.differences_[i];
    }
    int largest() const {
        long active = 0, most = -1;
        int best = kCentreCandidates / 2;
        for (int i = 0; i < kCentreCandidates; ++i) {
            active += differences_[static_cast<std::size_t>(i)];
            if (active > most) {
                most = active;
                best = i;
            }
        }
        return best;
    }

private:
    double first_, step_;
    std::array<long, kCentreCandidates + 1> differences_{};
};

// The edges that start in planes [begin, end). Each sample's place is found once, or once more at the seam.
template <class Sample>
void countPlanes(std::span<const Sample> samples, const GridDims& dims, std::int64_t begin, std::int64_t end,
                 CandidateCounts& counts) {
    const std::int64_t nx = dims[0], ny = dims[1], plane = nx * ny;
    std::vector<CandidateCounts::Place> here, above(static_cast<std::size_t>(plane));
    const auto placePlane = [&](std::int64_t z) {
        const Sample* from = samples.data() + plane * z;
        std::transform(from, from + plane, above.begin(), [&](Sample sample) { return counts.placeOf(sample); });
    };
    placePlane(begin);
    for (std::int64_t z = begin; z < end; ++z) {
        here = above;
        if (z + 1 < dims[2])
            placePlane(z + 1);
        for (std::int64_t y = 0; y < ny; ++y) {
            const CandidateCounts::Place* row = here.data() + nx * y;
            for (std::int64_t x = 0; x + 1 < nx; ++x)
                counts.addEdge(row[x], row[x + 1]);
            for (std::int64_t x = 0; x < nx && y + 1 < ny; ++x)
                counts.addEdge(row[x], row[x + nx]);
            for (std::int64_t x = 0; x < nx && z + 1 < dims[2]; ++x)
                counts.addEdge(row[x], above[static_cast<std::size_t>(nx * y + x)]);
        }
    }
}

std::vector<std::string> splitAtColons(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text)
        if (c == ':')
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

std::optional<std::int64_t> numberIn(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

Result<io::ReadOptions> rawOptions(const std::vector<std::string>& parts, const std::string& spec) {
    io::RawLayout layout;
    const auto type = scalarTypeFromName(parts[4]);
    const auto skip = parts.size() > 5 ? numberIn(parts[5]) : std::optional<std::int64_t>{0};
    for (std::size_t axis = 0; axis < 3; ++axis)
        layout.dims[axis] = numberIn(parts[axis + 1]).value_or(0);
    if (!type || !skip || *skip < 0 || parts.size() > 6)
        return makeError(ErrorCode::InvalidArgument, "want PATH:nx:ny:nz:TYPE[:skip]", spec);
    layout.type = *type;
    layout.skipBytes = static_cast<std::uint64_t>(*skip);
    io::ReadOptions options;
    options.allowsTrailing = true;
    options.raw = layout;
    return options;
}

// "shell256" and its like; null for any other name.
std::shared_ptr<const ScalarGrid> makeNamed(const std::string& spec) {
    const std::size_t digits = spec.find_first_of("0123456789");
    if (digits == std::string::npos)
        return nullptr;
    const std::string kind = spec.substr(0, digits);
    const auto size = numberIn(std::string_view(spec).substr(digits));
    if (!size || *size < 2 || *size > 2048)
        return nullptr;
    const int n = static_cast<int>(*size);
    if (kind == "shell")
        return std::make_shared<const ScalarGrid>(makeShell(n));
    if (kind == "ml")
        return std::make_shared<const ScalarGrid>(makeMarschnerLobb(n));
    if (kind == "noise")
        return std::make_shared<const ScalarGrid>(makeNoise(n));
    if (kind == "ct")
        return std::make_shared<const ScalarGrid>(makeNoisyScan(n));
    if (kind == "white")
        return std::make_shared<const ScalarGrid>(makeWhiteNoise(n));
    return nullptr;
}

// A map of 137 x 152 x 147 floats after a header of 1024 bytes.
Result<std::shared_ptr<const ScalarGrid>> readDensityMap(const std::filesystem::path& path) {
    constexpr std::uint64_t kHeaderBytes = 1024;
    GridGeometry geometry;
    geometry.dims = {137, 152, 147};
    std::vector<std::byte> bytes(static_cast<std::size_t>(pointCount(geometry.dims)) * sizeof(float));
    auto stream = io::openDeflated(path, 0, kHeaderBytes, bytes.size());
    if (!stream.isOk())
        return std::move(stream).error();
    ISO_TRY(stream.value()->readAt(0, bytes));
    return std::make_shared<const ScalarGrid>(geometry, ScalarType::F32, std::move(bytes));
}

Result<std::shared_ptr<const ScalarGrid>> readFurther(const std::string& name) {
    const std::filesystem::path data = std::filesystem::path(ISOSLIDER_SHARED_DIR) / "data";
    const bool isMap = name == "jmjd2da";
    const auto path = isMap ? data / "density" / "JMJD2DA-x336_event2.ccp4.gz" : data / "mhd" / "cranium.mhd";
    if (!std::filesystem::exists(path))
        return makeError(ErrorCode::NotFound, "no such file among the further volumes", path.string());
    return isMap ? readDensityMap(path) : io::readVolume(path);
}

} // namespace

bool isFurtherVolume(const std::string& spec) { return spec == "cranium" || spec == "jmjd2da"; }

ScalarGrid makeShell(int size) {
    const double centre = size / 2; // a grid point
    const double radius = 79.1 * size / 256.0;
    const double largest = std::max(radius, std::sqrt(3.0) * centre - radius);
    return makeCube<std::uint16_t>(size, ScalarType::U16, [=](int z, std::uint16_t* out) {
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double dx = x - centre, dy = y - centre, dz = z - centre;
                const double distance = std::sqrt(dx * dx + dy * dy + dz * dz);
                *out++ = // rounded half up, without a call
                    static_cast<std::uint16_t>(65535.0 * std::fabs(distance - radius) / largest + 0.5);
            }
    });
}

ScalarGrid makeMarschnerLobb(int size) {
    constexpr double kPi = std::numbers::pi, kAlpha = 0.25, kFrequency = 6;
    return makeCube<float>(size, ScalarType::F32, [=](int z, float* out) {
        const auto onAxis = [=](int i) { return -1 + 2.0 * i / (size - 1); };
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double px = onAxis(x), py = onAxis(y), pz = onAxis(z);
                const double wave = std::cos(2 * kPi * kFrequency * std::cos(kPi * std::sqrt(px * px + py * py) / 2));
                *out++ = static_cast<float>((1 - std::sin(kPi * pz / 2) + kAlpha * (1 + wave)) / (2 * (1 + kAlpha)));
            }
    });
}

ScalarGrid makeNoise(int size) {
    return makeCube<float>(size, ScalarType::F32, [=](int z, float* out) {
        for (int y = 0; y < size; ++y) {
            float* row = out + static_cast<std::size_t>(size) * static_cast<std::size_t>(y);
            std::fill_n(row, size, 0.0f);
            float amplitude = 1;
            for (std::uint32_t octave = 0; octave < 4; ++octave, amplitude *= 0.5f)
                addOctave(octave, amplitude, size, y, z, row);
        }
    });
}

ScalarGrid makeWhiteNoise(int size) {
    return makeCube<float>(size, ScalarType::F32, [=](int z, float* out) {
        std::mt19937_64 random(static_cast<std::uint64_t>(z));
        std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
        for (int i = 0; i < size * size; ++i)
            *out++ = uniform(random);
    });
}

ScalarGrid makeNoisyScan(int size) {
    constexpr float kTissue = 170.0f, kNoise = 34.0f; // amplitudes
    const int planes = std::max(2, size * 275 / 512);
    return makePlanes<std::int16_t>(size, planes, ScalarType::I16, [=](int z, std::int16_t* out) {
        const auto inEllipse = [size](int x, int y, float cx, float cy, float rx, float ry) {
            const float u = (static_cast<float>(x) / static_cast<float>(size) - cx) / rx;
            const float v = (static_cast<float>(y) / static_cast<float>(size) - cy) / ry;
            return 1.0f - std::sqrt(u * u + v * v); // 0 on it
        };
        const auto step = [](float from, float to, float t) {
            return from + (to - from) * std::clamp(30.0f * t + 0.5f, 0.0f, 1.0f);
        };
        // Nearly normal, a sum of four; neighbours in a plane have some in common, as reconstruction leaves it.
        constexpr float kShare = 0.6f;
        std::vector<float> row(static_cast<std::size_t>(size)), noise(row.size()), last(row.size() + 1, 0.0f),
            next(last);
        const auto drawRow = [&](int y, std::vector<float>& drawn) {
            for (std::size_t x = 0; x < drawn.size(); ++x) {
                drawn[x] = 0.0f;
                for (std::uint32_t k = 0; k < 4; ++k)
                    drawn[x] += latticeValue(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                             static_cast<std::uint32_t>(z), 16 + k);
            }
        };
        drawRow(0, next);
        for (int y = 0; y < size; ++y) {
            std::swap(last, next);
            drawRow(y + 1, next);
            for (std::size_t x = 0; x < noise.size(); ++x)
                noise[x] = (last[x] + kShare * (last[x + 1] + next[x]) + kShare * kShare * next[x + 1]) /
                           (1.0f + kShare * kShare);
            std::fill(row.begin(), row.end(), 0.0f);
            for (const std::uint32_t octave : {2u, 3u})
                addOctave(octave, octave == 2 ? kTissue : kTissue / 2, size, y, z, row.data());
            for (int x = 0; x < size; ++x) {
                float value = step(-1000.0f, 100.0f + row[static_cast<std::size_t>(x)],
                                   inEllipse(x, y, 0.5f, 0.5f, 0.42f, 0.33f));
                value = step(value, -750.0f, inEllipse(x, y, 0.33f, 0.45f, 0.11f, 0.16f)); // lungs
                value = step(value, -750.0f, inEllipse(x, y, 0.67f, 0.45f, 0.11f, 0.16f));
                value = step(value, 900.0f, inEllipse(x, y, 0.5f, 0.72f, 0.06f, 0.05f)); // spine
                *out++ = static_cast<std::int16_t>(
                    std::lround(std::clamp(value + kNoise * noise[static_cast<std::size_t>(x)], -1024.0f, 3000.0f)));
            }
        }
    });
}

double centreIsovalue(const ScalarGrid& grid, double min, double max) {
    const double first = min + 0.3 * (max - min);
    const double step = 0.4 * (max - min) / (kCentreCandidates - 1);
    CandidateCounts all(first, step);
    std::mutex mutex;
    grid.visit([&](auto samples) {
        const tbb::blocked_range<std::int64_t> planes(0, grid.dims()[2], 16);
        tbb::parallel_for(planes, [&](const tbb::blocked_range<std::int64_t>& range) {
            CandidateCounts counts(first, step);
            countPlanes(samples, grid.dims(), range.begin(), range.end(), counts);
            const std::lock_guard lock(mutex);
            all.add(counts);
        });
    });
    return first + step * all.largest();
}

std::vector<double> slide(const BenchVolume& volume, double percent, int steps) {
    const double range = volume.max - volume.min;
    const double step = range * percent / 100;
    const double lowest = volume.min + 0.02 * range, highest = volume.min + 0.98 * range;
    const bool isInteger = !isFloatType(volume.grid->type());
    double at = std::max(lowest, volume.centre - step * steps / 2);
    double direction = 1;
    std::vector<double> isovalues;
    for (int i = 0; i <= steps; ++i) {
        const bool isOnSample = isInteger && std::fabs(at - std::round(at)) < 1e-6;
        isovalues.push_back(isOnSample ? at + 0.001 : at);
        const double next = at + direction * step;
        if (next > highest || next < lowest)
            direction = -direction;
        at += direction * step;
    }
    return isovalues;
}

Result<BenchVolume> loadWorkload(const std::string& spec, const std::filesystem::path& resourcesDir) {
    BenchVolume volume;
    volume.name = spec;
    volume.grid = makeNamed(spec);
    if (!volume.grid) {
        const auto parts = splitAtColons(spec);
        io::ReadOptions options;
        if (parts.size() >= 5) {
            auto raw = rawOptions(parts, spec);
            if (!raw.isOk())
                return std::move(raw).error();
            options = std::move(raw).value();
        }
        auto read = isFurtherVolume(spec) ? readFurther(spec)
                    : spec == "bluntfin"  ? io::loadSample(spec, {0, 0, 0}, resourcesDir)
                                          : io::readVolume(parts.size() >= 5 ? parts[0] : spec, options);
        if (!read.isOk())
            return std::move(read).error();
        volume.grid = std::move(read).value();
        if (spec != "bluntfin" && !isFurtherVolume(spec))
            volume.name = std::filesystem::path(parts.size() >= 5 ? parts[0] : spec).filename().string();
    }
    findRange(volume);
    volume.centre = centreIsovalue(*volume.grid, volume.min, volume.max);
    return volume;
}

} // namespace isoslider::bench
