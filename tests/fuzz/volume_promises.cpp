#include "tests/fuzz/volume_promises.h"

#include <algorithm>
#include <vector>

#include "tests/fuzz/fuzz_support.h"

namespace isoslider::fuzz {
namespace {

constexpr std::size_t kMaxFields = 3;
constexpr std::int64_t kSlabPlanes = 3;

void readSlabs(io::VolumeSource& source) {
    const auto [nx, ny, nz] = source.info().geometry.dims;
    const std::int64_t planeSamples = nx * ny;
    if (planeSamples > kMaxSamples)
        return;
    const auto planeBytes = static_cast<std::size_t>(planeSamples) * scalarTypeSizeBytes(source.info().type);
    const std::int64_t zEnd = planeSamples * nz <= kMaxSamples ? nz : 1;
    std::vector<std::byte> slab, firstPlane;
    for (std::int64_t z = 0; z < zEnd; z += kSlabPlanes) {
        slab.resize(planeBytes * static_cast<std::size_t>(std::min(kSlabPlanes, zEnd - z)));
        const Status status = source.readSlab(z, std::min(z + kSlabPlanes, zEnd), slab);
        if (!status.isOk())
            return requireGoodError(status.error());
        if (z == 0)
            firstPlane.assign(slab.begin(), slab.begin() + static_cast<std::ptrdiff_t>(planeBytes));
    }
    slab.resize(planeBytes);
    const Status again = source.readSlab(0, 1, slab);
    ISO_REQUIRE(again.isOk(), again.isOk() ? "" : again.error().line());
    ISO_REQUIRE(slab == firstPlane, source.info().format);
}

void openAndRead(io::OpenFormat* open, const std::filesystem::path& path, const io::ReadOptions& options,
                 const io::VolumeField* listed) {
    auto opened = open(path, options);
    if (!opened.isOk())
        return requireGoodError(opened.error());
    const io::VolumeInfo& info = opened.value()->info();
    requireGoodGeometry(info.geometry);
    requireLine(info.format);
    for (const std::string& note : info.notes)
        requireLine(note);
    if (listed != nullptr) {
        ISO_REQUIRE(listed->problem.empty(), listed->problem);
        ISO_REQUIRE(info.geometry.dims == listed->dims, listed->name);
    }
    readSlabs(*opened.value());
}

void tryField(io::OpenFormat* open, const std::filesystem::path& path, io::ReadOptions options,
              const io::VolumeField& field) {
    ISO_REQUIRE(field.components >= 1 && field.frames >= 1, field.name);
    ISO_REQUIRE(!field.problem.empty() || std::ranges::all_of(field.dims, [](auto size) { return size >= 1; }),
                field.name);
    ISO_REQUIRE(field.componentNames.empty() ||
                    field.componentNames.size() == static_cast<std::size_t>(field.components),
                field.name);
    requireLine(field.typeName);
    for (const std::string* text : {&field.title, &field.problem})
        if (!text->empty())
            requireLine(*text);
    for (const std::string& name : field.componentNames)
        requireLine(name);
    options.field = field.name;
    options.component = field.components > 1 && field.hasMagnitude ? io::kMagnitude : field.components - 1;
    options.frame = field.frames - 1;
    openAndRead(open, path, options, &field);
    if (!field.needsChoice())
        return;
    options.component = 0;
    options.frame = 0;
    openAndRead(open, path, options, &field);
}

} // namespace

void requireVolumePromises(io::OpenFormat* open, io::ListFormat* list, const std::filesystem::path& path,
                           const io::ReadOptions& options) {
    openAndRead(open, path, options, nullptr);
    const auto listed = list != nullptr ? list(path, options) : io::listByOpening(*open, path, options);
    if (!listed.isOk())
        return requireGoodError(listed.error());
    const io::VolumeContents& contents = listed.value();
    ISO_REQUIRE(contents.fields.empty() || contents.preferred < contents.fields.size(), contents.format);
    for (std::size_t i = 0; i < std::min(contents.fields.size(), kMaxFields); ++i)
        tryField(open, path, options, contents.fields[i]);
}

} // namespace isoslider::fuzz
