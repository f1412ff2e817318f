#include <algorithm>

#include "core/volume_io/formats/arrays/netcdf_classic_header.h"
#include "core/volume_io/formats/simulations/plot3d_layout.h"
#include "core/volume_io/formats/vtk/vtk_legacy_header.h"
#include "core/volume_io/formats/vtk/vtk_xml_header.h"
#include "core/volume_io/volume_choice.h"
#include "tests/fuzz/fuzz_support.h"
#include "tests/fuzz/fuzz_targets.h"

// Of formats that a library reads: what we check before it sees the file.

namespace isoslider::fuzz {
namespace {

/// Refusals name the fields, whose names are the file's.
void chooseAmong(const io::VolumeContents& contents, const std::filesystem::path& path) {
    io::ReadOptions options;
    for (const char* name : {"", "none such"}) {
        options.field = name;
        const auto chosen = io::chooseField(contents, options, path);
        if (!chosen.isOk()) {
            requireGoodError(chosen.error());
            continue;
        }
        const auto choice = io::chooseIn(contents.fields[chosen.value()], options, path);
        if (!choice.isOk())
            requireGoodError(choice.error());
    }
}

} // namespace

void fuzzVtkXml(std::span<const std::byte> bytes) {
    const BytesFile file(bytes, "input.vti");
    const auto header = io::readVtkXmlHeader(file);
    if (!header.isOk())
        return requireGoodError(header.error());
    const io::VolumeContents contents = contentsOf(header.value());
    ISO_REQUIRE(!contents.fields.empty() && contents.preferred < contents.fields.size(), contents.format);
    ISO_REQUIRE(contents.fields.size() == header.value().outline.pointArrays.size(), contents.format);
    chooseAmong(contents, file.path());
    for (std::size_t i = 0; i < contents.fields.size(); ++i) {
        ISO_REQUIRE(contents.fields[i].components >= 1, contents.fields[i].name);
        if (!contents.fields[i].problem.empty())
            requireLine(contents.fields[i].problem);
        const Status room = checkVtkXmlRoom(file, header.value(), i);
        if (!room.isOk())
            requireGoodError(room.error());
    }
}

void fuzzVtkLegacy(std::span<const std::byte> bytes) {
    const BytesFile file(bytes, "input.vtk");
    io::LegacyRequest request;
    request.keepsStructure = true;
    const auto whole = io::readLegacyHeader(file, request);
    request.keepsStructure = false;
    request.isLast = [](const io::LegacyArray&) { return true; };
    const auto first = io::readLegacyHeader(file, request);
    if (!first.isOk())
        requireGoodError(first.error());
    if (!whole.isOk())
        return requireGoodError(whole.error());
    ISO_REQUIRE(first.isOk(), "a file that passes to its end does so to its first array");
    for (const io::LegacyArray& array : whole.value().arrays) {
        ISO_REQUIRE(array.components >= 1 && array.position <= bytes.size(), array.name);
        if (whole.value().isBinary)
            ISO_REQUIRE(whole.value().points * array.components * fileTypeSizeBytes(array.type) <= bytes.size(),
                        array.name);
    }
}

/// A grid, a solution, or both one after the other, of floats without marks.
void fuzzPlot3d(std::span<const std::byte> bytes) {
    for (const bool isGrid : {true, false}) {
        const auto layout = io::detectPlot3dLayout(BytesFile(bytes), isGrid);
        if (!layout.isOk()) {
            requireGoodError(layout.error());
            continue;
        }
        const auto points = static_cast<std::uint64_t>(pointCount(layout.value().dims));
        ISO_REQUIRE(points >= 8 && points * (layout.value().isDouble ? 8 : 4) * (isGrid ? 3 : 5) < bytes.size(), "");
    }
    // Of a file of P points: 12 + 12 P bytes of grid, 28 + 20 P of solution.
    const std::size_t points = bytes.size() < 40 ? 0 : (bytes.size() - 40) / 32;
    const std::size_t gridBytes = std::min(bytes.size(), 12 + 12 * points);
    const auto pair = io::detectPlot3dPair(BytesFile(bytes.first(gridBytes)), BytesFile(bytes.subspan(gridBytes)));
    if (!pair.isOk())
        requireGoodError(pair.error());
}

void fuzzNetcdf(std::span<const std::byte> bytes) {
    const Status status = io::checkClassicNetcdf(BytesFile(bytes));
    if (!status.isOk())
        requireGoodError(status.error());
}

} // namespace isoslider::fuzz
