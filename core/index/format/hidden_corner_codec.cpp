#include "core/index/format/hidden_corner_codec.h"

#include <cmath>

#include "core/grid/scalar_key.h"
#include "core/index/format/byte_planes.h"

namespace isoslider::index {
namespace {

constexpr std::size_t kHeaderBytes = 16;
constexpr int kPlaceBytes = 4;

int keyBytesOf(ScalarType type) {
    return visitScalarType(type, [](auto sample) { return static_cast<int>(sizeof(KeyOf<decltype(sample)>)); });
}

// False for a key that no sample of the volume has.
template <class Sample>
bool scalarOfKey(std::uint64_t key, double min, double max, double& scalar) {
    const Sample sample = sampleOfKey<Sample>(static_cast<KeyOf<Sample>>(key));
    scalar = static_cast<double>(sample);
    return std::isfinite(scalar) && scalar >= min && scalar <= max && keyOf(sample) == key;
}

// Differences to places; false when they do not rise, or name no cell of the grid.
bool restorePlaces(std::vector<std::uint32_t>& places, const HiddenPageEntry& entry, const BrickGrid& grid) {
    const std::uint64_t end = (std::uint64_t{entry.lastBrick - entry.firstBrick} + 1) * kHiddenPlacesPerBrick;
    std::uint64_t place = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i > 0 && places[i] == 0)
            return false;
        place += places[i];
        if (place >= end)
            return false;
        places[i] = static_cast<std::uint32_t>(place);
        const PointId first = pointIn(entry.firstBrick, LocalPoint());
        const auto p = grid.pointCoords(first + place / 8);
        for (int a = 0; a < 3; ++a)
            if (p[a] + 1 >= grid.dims()[a])
                return false;
    }
    return places.front() < kHiddenPlacesPerBrick && places.back() >= end - kHiddenPlacesPerBrick;
}

} // namespace

std::vector<std::byte> encodeHiddenPage(std::span<const HiddenCorner> corners, ScalarType type) {
    ISO_CHECK(!corners.empty() && corners.size() <= kMaxHiddenPageCorners);
    const BrickIndex firstBrick = corners.front().brick;
    ISO_CHECK(corners.back().brick - firstBrick < kMaxHiddenPageBricks);
    std::vector<std::uint32_t> places;
    std::vector<std::uint64_t> keys;
    places.reserve(corners.size());
    keys.reserve(corners.size());
    std::uint32_t previous = 0;
    for (const HiddenCorner& corner : corners) {
        const std::uint32_t place = (corner.brick - firstBrick) * kHiddenPlacesPerBrick + corner.place;
        places.push_back(place - previous);
        keys.push_back(corner.key);
        previous = place;
    }
    const int keyBytes = keyBytesOf(type);
    std::vector<std::byte> bytes;
    ByteWriter header(bytes);
    header.put<std::uint32_t>(static_cast<std::uint32_t>(corners.size()));
    header.put<std::uint32_t>(firstBrick.number());
    header.put<std::uint32_t>(static_cast<std::uint32_t>(keyBytes));
    header.put<std::uint32_t>(static_cast<std::uint32_t>(kPlaceBytes + keyBytes));
    PlaneWriter writer(bytes, kPlaceBytes + keyBytes);
    writer.addColumn(places, kPlaceBytes);
    writer.addColumn(keys, keyBytes);
    ISO_CHECK(writer.isComplete() && bytes.size() <= kMaxHiddenPageBytes);
    return bytes;
}

HiddenPageEntry hiddenPageEntry(std::span<const HiddenCorner> corners) {
    HiddenPageEntry entry;
    entry.firstBrick = corners.front().brick;
    entry.lastBrick = corners.back().brick;
    entry.corners = static_cast<std::uint32_t>(corners.size());
    return entry;
}

Status decodeHiddenPage(std::span<const std::byte> bytes, const HiddenPageEntry& entry, const IndexInfo& info,
                        HiddenPage& page, const std::string& path) {
    PlaneReader reader(bytes, path, entry.offset);
    ByteReader header(bytes);
    const std::size_t count = header.get<std::uint32_t>();
    const BrickIndex firstBrick(header.get<std::uint32_t>());
    const std::uint32_t keyBytes = header.get<std::uint32_t>();
    const std::uint32_t planes = header.get<std::uint32_t>();
    if (header.hasFailed())
        return reader.corrupt("header is cut off");
    if (count == 0 || count > kMaxHiddenPageCorners || count != entry.corners || firstBrick != entry.firstBrick)
        return reader.corrupt("hidden corners disagree with the directory");
    if (keyBytes != static_cast<std::uint32_t>(keyBytesOf(info.type)) || planes != kPlaceBytes + keyBytes)
        return reader.corrupt("header field");
    ISO_TRY(reader.beginPlanes(kHeaderBytes, planes));
    ISO_TRY(reader.readColumn(page.places, count, kPlaceBytes));
    std::vector<std::uint64_t> keys;
    ISO_TRY(reader.readColumn(keys, count, static_cast<int>(keyBytes)));
    if (!reader.isAtEnd())
        return reader.corrupt("bytes after the last plane");
    if (!restorePlaces(page.places, entry, BrickGrid(info.geometry.dims)))
        return reader.corrupt("place of a hidden corner");
    page.scalars.resize(count);
    const bool areSamples = visitScalarType(info.type, [&](auto sample) {
        for (std::size_t i = 0; i < count; ++i)
            if (!scalarOfKey<decltype(sample)>(keys[i], info.min, info.max, page.scalars[i]))
                return false;
        return true;
    });
    if (!areSamples)
        return reader.corrupt("scalar of a hidden corner");
    return {};
}

} // namespace isoslider::index
