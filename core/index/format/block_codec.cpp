#include "core/index/format/block_codec.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/index/format/byte_planes.h"
#include "core/index/format/zigzag.h"

namespace isoslider::index {
namespace {

// Layout: FORMAT.md, "Page". Columns of residuals, in byte planes.

constexpr std::size_t kPageHeaderBytes = 32;

// Normals are read, of earlier versions, and not written.
enum PageFlag : std::uint8_t {
    kSecondDifferences = 1,
    kMirroredNormals = 2,
    kForms = 4,
    kWithoutNormals = 8,
    kDirections = 16
};
constexpr std::uint8_t kKnownFlags = kSecondDifferences | kMirroredNormals | kForms | kWithoutNormals | kDirections;
constexpr int kNormalBytes = sizeof(NormalCode);

// Far keys are left out where no record has one.
bool hasFarKeys(std::uint8_t flags) { return (flags & kDirections) == 0 || (flags & kForms) != 0; }

int planeCount(int keyBytes, int idBytes, std::uint8_t flags) {
    return keyBytes + idBytes + 1 + (flags & kForms ? 1 : 0) + (flags & kDirections ? 1 : 0) +
           (hasFarKeys(flags) ? keyBytes : 0) + (flags & kWithoutNormals ? 0 : 2 * kNormalBytes);
}

int bytesFor(std::uint64_t largest) { return std::max(1, (static_cast<int>(std::bit_width(largest)) + 7) / 8); }

// What the far scalar across the edge's axis suggests: the field goes on in a straight line.
template <class Key>
Key mirrored(Key key, Key opposite) {
    return static_cast<Key>(key + key - opposite);
}

// Byte by byte, modulo 256.
NormalCode subtractNormal(NormalCode a, NormalCode b) {
    return static_cast<NormalCode>(((a - b) & 0xff) | (((a >> 8) - (b >> 8)) & 0xff) << 8);
}
NormalCode addNormal(NormalCode a, NormalCode b) {
    return static_cast<NormalCode>(((a + b) & 0xff) | (((a >> 8) + (b >> 8)) & 0xff) << 8);
}
NormalCode mirroredNormal(NormalCode normal, NormalCode opposite) {
    return subtractNormal(addNormal(normal, normal), opposite);
}

/// The columns of a page while it is encoded; memory of a thread, used again for the next page.
template <class Key>
struct PageColumns {
    std::vector<Key> keys, farKeys, farKeysMirrored;
    std::vector<std::uint64_t> ids;
    std::vector<std::uint8_t> masks, forms, rising;
    std::int64_t keyBitsSaved = 0; ///< by predicting from the opposite edge
};

template <class Key>
PageColumns<Key>& pageColumns() {
    thread_local PageColumns<Key> columns;
    return columns;
}

// Residuals of what stands across the edges, against the point itself, and where both edges of an axis are there also
// the lower one's against what the upper one suggests. Upward edges have odd numbers.
template <class Key>
void findFarResiduals(std::span<const PointRecord<Key>> records, FarEnds farEnds, PageColumns<Key>& columns) {
    const std::size_t most = records.size() * kPointEdges;
    for (auto* column : {&columns.farKeys, &columns.farKeysMirrored})
        column->resize(most);
    columns.keyBitsSaved = 0;
    std::size_t n = 0;
    for (const PointRecord<Key>& r : records) {
        if (farEnds == FarEnds::Directions && r.form == record_form::kPoint)
            continue;
        for (unsigned mask = r.edgeMask; mask != 0; mask &= mask - 1, ++n) {
            const int e = std::countr_zero(mask);
            const Key key = zigzag(static_cast<Key>(r.farKeys[e] - r.key));
            columns.farKeys[n] = columns.farKeysMirrored[n] = key;
            if (e & 1 || !(mask >> (e + 1) & 1))
                continue;
            const Key mirroredKey = zigzag(static_cast<Key>(r.farKeys[e] - mirrored(r.key, r.farKeys[e + 1])));
            columns.farKeysMirrored[n] = mirroredKey;
            columns.keyBitsSaved +=
                static_cast<int>(std::bit_width(key)) - static_cast<int>(std::bit_width(mirroredKey));
        }
    }
    for (auto* column : {&columns.farKeys, &columns.farKeysMirrored})
        column->resize(n);
}

// A page by id is taken whole: where an edge's other end lies need not be seen from its own key.
bool statesKey(std::uint8_t form, PageOrder order, FarEnds farEnds) {
    return order == PageOrder::Value || farEnds == FarEnds::Keys || form != record_form::kPoint;
}

// The edges of a point that rise.
template <class Key>
std::uint8_t risingEdges(const PointRecord<Key>& record) {
    unsigned rising = 0;
    for (int e = 0; e < kPointEdges; ++e)
        rising |= unsigned{record.farKeys[e] > record.key} << e;
    return static_cast<std::uint8_t>(rising & record.edgeMask);
}

} // namespace

template <class Key>
std::vector<std::byte> encodePage(std::span<const PointRecord<Key>> records, PageOrder order, FarEnds farEnds,
                                  const BrickGrid& grid) {
    ISO_CHECK(!records.empty() && records.size() <= kMaxPagePoints);
    Key base = records.front().key;
    for (const PointRecord<Key>& r : records)
        base = std::min(base, r.key);
    const std::uint64_t idCount = grid.idCount();
    PageColumns<Key>& columns = pageColumns<Key>();
    columns.keys.clear();
    columns.ids.clear();
    columns.masks.clear();
    columns.forms.clear();
    columns.rising.clear();
    bool hasForms = false;
    std::size_t entries = 0;
    Key previousKey = base;
    std::uint64_t previousId = 0;
    for (const PointRecord<Key>& r : records) {
        columns.keys.push_back(statesKey(r.form, order, farEnds)
                                   ? static_cast<Key>(r.key - (order == PageOrder::Value ? previousKey : base))
                                   : Key(0));
        const std::uint64_t id = r.id().number();
        columns.ids.push_back(id >= previousId ? id - previousId : id + (idCount - previousId));
        columns.masks.push_back(r.edgeMask);
        columns.forms.push_back(r.form);
        columns.rising.push_back(r.form == record_form::kPoint ? risingEdges(r) : std::uint8_t{0});
        entries += static_cast<std::size_t>(std::popcount(r.edgeMask));
        hasForms = hasForms || r.form != record_form::kPoint;
        previousKey = r.key;
        previousId = id;
    }
    findFarResiduals(records, farEnds, columns);
    const bool mirrorsKeys = columns.keyBitsSaved > 0;
    const auto flags = static_cast<std::uint8_t>((mirrorsKeys ? kSecondDifferences : 0) | (hasForms ? kForms : 0) |
                                                 kWithoutNormals | (farEnds == FarEnds::Directions ? kDirections : 0));

    constexpr int kKeyBytes = sizeof(Key);
    const int idBytes = bytesFor(idCount);
    const int planes = planeCount(kKeyBytes, idBytes, flags);
    std::vector<std::byte> bytes;
    bytes.reserve(records.size() * 20 + 512);
    ByteWriter header(bytes);
    header.put<std::uint32_t>(static_cast<std::uint32_t>(records.size()));
    header.put<std::uint32_t>(static_cast<std::uint32_t>(entries));
    header.put<std::uint64_t>(base);
    header.put<std::uint8_t>(kKeyBytes);
    header.put<std::uint8_t>(static_cast<std::uint8_t>(idBytes));
    header.put<std::uint8_t>(static_cast<std::uint8_t>(order));
    header.put<std::uint8_t>(flags);
    header.put<std::uint32_t>(static_cast<std::uint32_t>(planes));
    header.put<std::uint64_t>(0); // reserved
    PlaneWriter writer(bytes, planes);
    writer.addColumn(columns.keys, kKeyBytes);
    writer.addColumn(columns.ids, idBytes);
    writer.addColumn(columns.masks, 1);
    if (hasForms)
        writer.addColumn(columns.forms, 1);
    if (farEnds == FarEnds::Directions)
        writer.addColumn(columns.rising, 1);
    if (hasFarKeys(flags))
        writer.addColumn(mirrorsKeys ? columns.farKeysMirrored : columns.farKeys, kKeyBytes);
    ISO_CHECK(writer.isComplete());
    return bytes;
}

// ---- reading

namespace {

// Whether a record of merged cells has its entries, and its edge or cell lies in the grid, aligned.
bool fits(std::uint8_t form, std::uint8_t mask, const std::array<std::int64_t, 3>& point, const GridDims& dims) {
    if (form >= record_form::kEnd || mask != record_form::maskOf(form))
        return false;
    const std::int64_t side = std::int64_t{1} << record_form::levelOf(form);
    for (int a = 0; a < 3; ++a) {
        const std::int64_t at = point[static_cast<std::size_t>(a)], inside = at & (side - 1);
        const bool isAlong = record_form::isEdge(form) && a == record_form::axisOf(form);
        const bool reachesOn = isAlong || !record_form::isEdge(form);
        if (at < 0 || at >= dims[a] || (!isAlong && inside != 0) || (reachesOn && at - inside + side >= dims[a]))
            return false;
    }
    return true;
}

// Whether the ends of leaf edges lie on both sides of the isovalue while they carry a vertex.
template <class Key>
bool enclosesIntervals(const DecodedPage<Key>& page) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < page.forms.size(); ++i) {
        if (record_form::isEdge(page.forms[i])) {
            const Key other = page.farKeys[at], lower = page.farKeys[at + 1], upper = page.farKeys[at + 2];
            if (std::min(lower, upper) > std::min(page.keys[i], other) ||
                std::max(lower, upper) < std::max(page.keys[i], other) || lower == upper)
                return false;
        }
        at += page.hasFarKeys(i) ? static_cast<std::size_t>(std::popcount(page.masks[i])) : 0;
    }
    return true;
}

// Residuals back to ids and keys, checking every id and edge against the grid.
template <class Key>
Status restorePoints(DecodedPage<Key>& page, Key base, PageOrder order, const BrickGrid& grid,
                     const PlaneReader& reader) {
    const std::uint64_t idCount = grid.idCount();
    Key previousKey = base;
    std::uint64_t previousId = 0;
    std::size_t edges = 0;
    for (std::size_t i = 0; i < page.pointCount(); ++i) {
        if (page.keys[i] != 0 && !statesKey(page.form(i), order, page.farEnds))
            return reader.corrupt("key of a point");
        const Key key = static_cast<Key>(page.keys[i] + (order == PageOrder::Value ? previousKey : base));
        if (key < previousKey && order == PageOrder::Value)
            return reader.corrupt("keys out of order");
        page.keys[i] = previousKey = key;
        if (page.ids[i] >= idCount)
            return reader.corrupt("point id");
        std::uint64_t id = previousId + page.ids[i];
        id = id >= idCount ? id - idCount : id;
        page.ids[i] = previousId = id;
        const auto p = grid.pointCoords(PointId(id));
        if (const std::uint8_t form = page.form(i); form != record_form::kPoint) {
            if (!fits(form, page.masks[i], p, grid.dims()))
                return reader.corrupt("record of merged cells");
            edges += static_cast<std::size_t>(std::popcount(page.masks[i]));
            continue;
        }
        std::uint8_t allowed = 0;
        for (int a = 0; a < 3; ++a) {
            if (p[a] >= grid.dims()[a])
                return reader.corrupt("point id outside the grid");
            allowed |= static_cast<std::uint8_t>((p[a] > 0) << (2 * a) | (p[a] + 1 < grid.dims()[a]) << (2 * a + 1));
        }
        if (page.masks[i] & ~allowed)
            return reader.corrupt("edge outside the grid");
        edges += static_cast<std::size_t>(std::popcount(page.masks[i]));
    }
    if (edges != page.entries)
        return reader.corrupt("edge count");
    return {};
}

// Of records with far keys: calls one(i, at) for each edge alone on its axis, and pair(i, at) where both of an axis are
// there: entry `at` is the lower one, the next the upper.
template <class Key, class One, class Pair>
void forEachEntry(const DecodedPage<Key>& page, const One& one, const Pair& pair) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < page.pointCount(); ++i)
        for (unsigned mask = page.hasFarKeys(i) ? page.masks[i] : 0; mask != 0; mask &= mask - 1) {
            const int e = std::countr_zero(mask);
            if ((e & 1) || !(mask >> (e + 1) & 1)) {
                one(i, at++);
                continue;
            }
            pair(i, at);
            at += 2;
            mask &= mask - 1;
        }
}

template <class Key>
void restoreFarKeys(DecodedPage<Key>& page, bool areMirrored) {
    auto& far = page.farKeys;
    forEachEntry(
        page, [&](std::size_t i, std::size_t at) { far[at] = static_cast<Key>(unzigzag(far[at]) + page.keys[i]); },
        [&](std::size_t i, std::size_t at) {
            const Key key = page.keys[i], upper = static_cast<Key>(unzigzag(far[at + 1]) + key);
            far[at] = static_cast<Key>(unzigzag(far[at]) + (areMirrored ? mirrored(key, upper) : key));
            far[at + 1] = upper;
        });
}

// Directions of records with far keys.
template <class Key>
void findRising(DecodedPage<Key>& page) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < page.pointCount(); ++i) {
        if (!page.hasFarKeys(i))
            continue;
        const Key key = page.keys[i];
        const std::uint8_t mask = page.masks[i];
        unsigned rising = 0;
        if (page.form(i) != record_form::kPoint) { // the first is the other end of its interval
            rising = page.farKeys[at] > key ? mask : 0u;
            at += static_cast<std::size_t>(std::popcount(mask));
        } else {
            for (unsigned left = mask; left != 0; left &= left - 1)
                rising |= page.farKeys[at++] > key ? left & (0 - left) : 0u;
        }
        page.rising[i] = static_cast<std::uint8_t>(rising);
    }
}

// How many far keys a page with directions has.
template <class Key>
std::size_t entriesOfForms(const DecodedPage<Key>& page) {
    std::size_t entries = 0;
    for (std::size_t i = 0; i < page.forms.size(); ++i)
        entries += page.forms[i] != record_form::kPoint ? static_cast<std::size_t>(std::popcount(page.masks[i])) : 0;
    return entries;
}

template <class Key>
bool areDirectionsOfEdges(const DecodedPage<Key>& page) {
    for (std::size_t i = 0; i < page.pointCount(); ++i)
        if ((page.rising[i] & ~(page.form(i) == record_form::kPoint ? page.masks[i] : 0)) != 0)
            return false;
    return true;
}

template <class Key>
void restoreNormals(DecodedPage<Key>& page, bool areMirrored) {
    NormalCode previous = 0;
    for (NormalCode& normal : page.normals)
        normal = previous = addNormal(normal, previous);
    auto& far = page.farNormals;
    forEachEntry(
        page, [&](std::size_t i, std::size_t at) { far[at] = addNormal(far[at], page.normals[i]); },
        [&](std::size_t i, std::size_t at) {
            const NormalCode normal = page.normals[i], upper = addNormal(far[at + 1], normal);
            far[at] = addNormal(far[at], areMirrored ? mirroredNormal(normal, upper) : normal);
            far[at + 1] = upper;
        });
}

} // namespace

template <class Key>
Status decodePage(std::span<const std::byte> bytes, const BrickGrid& grid, DecodedPage<Key>& page,
                  const std::string& path) {
    PlaneReader reader(bytes, path);
    if (bytes.size() < kPageHeaderBytes)
        return reader.corrupt("header is cut off");
    ByteReader header(bytes.first(kPageHeaderBytes));
    const std::size_t points = header.get<std::uint32_t>();
    const std::size_t edges = header.get<std::uint32_t>();
    const std::uint64_t base = header.get<std::uint64_t>();
    const int keyBytes = header.get<std::uint8_t>();
    const int idBytes = header.get<std::uint8_t>();
    const std::uint8_t order = header.get<std::uint8_t>();
    const std::uint8_t flags = header.get<std::uint8_t>();
    const std::uint32_t planes = header.get<std::uint32_t>();
    if (points == 0 || points > kMaxPagePoints || edges > points * kPointEdges)
        return reader.corrupt("point or edge count");
    if (keyBytes != sizeof(Key) || idBytes != bytesFor(grid.idCount()) || order > 1 || (flags & ~kKnownFlags) != 0 ||
        planes != static_cast<std::uint32_t>(planeCount(keyBytes, idBytes, flags)) ||
        base > std::numeric_limits<Key>::max())
        return reader.corrupt("header field");
    ISO_TRY(reader.beginPlanes(kPageHeaderBytes, planes));
    ISO_TRY(reader.readColumn(page.keys, points, keyBytes));
    ISO_TRY(reader.readColumn(page.ids, points, idBytes));
    ISO_TRY(reader.readColumn(page.masks, points, 1));
    page.forms.clear();
    if (flags & kForms)
        ISO_TRY(reader.readColumn(page.forms, points, 1));
    const bool hasNormals = (flags & kWithoutNormals) == 0;
    page.normals.clear();
    page.farNormals.clear();
    if (hasNormals)
        ISO_TRY(reader.readColumn(page.normals, points, kNormalBytes));
    page.farEnds = flags & kDirections ? FarEnds::Directions : FarEnds::Keys;
    page.entries = edges;
    page.rising.assign(points, 0);
    if (flags & kDirections)
        ISO_TRY(reader.readColumn(page.rising, points, 1));
    page.farKeys.clear();
    if (hasFarKeys(flags))
        ISO_TRY(reader.readColumn(page.farKeys, flags & kDirections ? entriesOfForms(page) : edges, keyBytes));
    if (hasNormals)
        ISO_TRY(reader.readColumn(page.farNormals, edges, kNormalBytes));
    if (!reader.isAtEnd())
        return reader.corrupt("bytes after the last plane");
    ISO_TRY(restorePoints(page, static_cast<Key>(base), static_cast<PageOrder>(order), grid, reader));
    if (!areDirectionsOfEdges(page))
        return reader.corrupt("directions");
    restoreFarKeys(page, (flags & kSecondDifferences) != 0);
    findRising(page);
    if (hasNormals)
        restoreNormals(page, (flags & kMirroredNormals) != 0);
    if (!enclosesIntervals(page))
        return reader.corrupt("leaf edge");
    return {};
}

template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint16_t>>, PageOrder, FarEnds,
                                           const BrickGrid&);
template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint32_t>>, PageOrder, FarEnds,
                                           const BrickGrid&);
template std::vector<std::byte> encodePage(std::span<const PointRecord<std::uint64_t>>, PageOrder, FarEnds,
                                           const BrickGrid&);
template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint16_t>&,
                           const std::string&);
template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint32_t>&,
                           const std::string&);
template Status decodePage(std::span<const std::byte>, const BrickGrid&, DecodedPage<std::uint64_t>&,
                           const std::string&);

} // namespace isoslider::index
