#include "ui/render/brick_buffers.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "ui/render/brick_draft.h"
#include "ui/render/draw_parts.h"
#include "ui/render/tint_arrays.h"

namespace isoslider::render {
namespace {

using extract::PictureBrick;
using Record = BrickBuffers::Picture::Record;

constexpr std::size_t kPage = 512; // places that are sent together
constexpr std::size_t kMostTogether = std::size_t{4} << 20; // bytes of a fresh buffer that are sent together

/// The planes of the view: what is in it is on the positive side of each.
std::vector<glm::dvec4> viewPlanes(const glm::dmat4& modelToClip) {
    const auto row = [&](int i) {
        return glm::dvec4(modelToClip[0][i], modelToClip[1][i], modelToClip[2][i], modelToClip[3][i]);
    };
    return {row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) + row(2), row(3) - row(2)};
}

bool isInView(const PictureBrick& brick, const std::vector<glm::dvec4>& planes) {
    const auto origin = brick.origin();
    const glm::dvec3 low(origin[0], origin[1], origin[2]);
    return std::all_of(planes.begin(), planes.end(), [&](const glm::dvec4& plane) {
        // The corner that lies farthest along the plane's normal.
        const glm::dvec3 corner =
            low + glm::dvec3(extract::kCellSide) * glm::dvec3(plane.x > 0.0, plane.y > 0.0, plane.z > 0.0);
        return glm::dot(glm::dvec3(plane), corner) + plane.w >= 0.0;
    });
}

} // namespace

BrickBuffers::BrickBuffers(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {
    GLint most = 0;
    gl_.glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    mostPlaces_ = static_cast<std::uint64_t>(std::max(0, most));
    gl_.glGenVertexArrays(1, &vertexArray_);
    gl_.glGenTextures(1, &placesTexture_);
    for (Buffer* buffer : {&records_, &indices_, &places_, &changedIndices_, &tints_, &coarseIndices_})
        buffer->name = driver_.makeBuffer(gl_);
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ARRAY_BUFFER, records_.name);
    gl_.glEnableVertexAttribArray(0);
    gl_.glVertexAttribIPointer(0, 4, GL_UNSIGNED_SHORT, sizeof(Record), nullptr);
    gl_.glEnableVertexAttribArray(1);
    gl_.glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(Record),
                              reinterpret_cast<const void*>(offsetof(Record, scalar1)));
    gl_.glBindVertexArray(0);
}

BrickBuffers::~BrickBuffers() {
    if (vertexArray_ == 0)
        return;
    for (const Buffer* buffer : {&records_, &indices_, &places_, &changedIndices_, &tints_, &coarseIndices_})
        driver_.freeBuffer(gl_, buffer->name);
    gl_.glDeleteTextures(1, &placesTexture_);
    gl_.glDeleteVertexArrays(1, &vertexArray_);
}

void BrickBuffers::clear() {
    coarse_.clear();
    sentTints_.clear();
    bricks_.clear();
    changed_.clear();
    counts_.clear();
    series_ = 0;
}

void BrickBuffers::freeMemory() {
    clear();
    for (Buffer* buffer : {&records_, &indices_, &places_, &changedIndices_, &tints_, &coarseIndices_})
        if (std::exchange(buffer->capacityBytes, 0) > 0)
            driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, buffer->name, 0);
}

bool BrickBuffers::upload(const Picture& picture) {
    if (picture.series() != series_)
        clear();
    isFresh_ = series_ == 0;
    gl_.glBindVertexArray(vertexArray_);
    if (!makeRoom(picture)) {
        freeMemory();
        gl_.glBindVertexArray(0);
        return false;
    }
    const auto now = picture.bricks();
    if (isFresh_ || isMostlyNew(now)) {
        isFresh_ = true;
        bricks_.clear();
    }
    bricks_.resize(now.size());
    placeTable_.resize((picture.recordEnd() + kRecordsPerPlace - 1) / kRecordsPerPlace);
    std::vector<Stretch> records, indices;
    std::vector<std::uint64_t> pages;
    for (std::size_t slot = 0; slot < now.size(); ++slot) {
        const PictureBrick& brick = now[slot];
        if (brick == bricks_[slot])
            continue;
        bricks_[slot] = brick;
        if (brick.indexCount == 0)
            continue;
        records.push_back({brick.firstRecord, brick.recordCount, picture.records(brick)});
        indices.push_back({brick.firstIndex, brick.indexCount, picture.indices(brick)});
        const std::uint64_t first = brick.firstRecord / kRecordsPerPlace;
        const std::uint64_t last = (brick.firstRecord + std::uint64_t{brick.recordCount} - 1) / kRecordsPerPlace;
        for (std::uint64_t place = first; place <= last; ++place) {
            placeTable_[place] = {brick.place[0], brick.place[1], brick.place[2], 0};
            if (pages.empty() || pages.back() != place / kPage)
                pages.push_back(place / kPage);
        }
    }
    send(GL_COPY_WRITE_BUFFER, records_, sizeof(Record), records);
    send(GL_COPY_WRITE_BUFFER, indices_, sizeof(std::uint16_t), indices);
    sendPlaces(pages);
    series_ = picture.series();
    const bool hasRoom = sendChanged(picture);
    gl_.glBindVertexArray(0);
    if (!hasRoom) // the surface without the marks is better than none
        changed_.clear();
    return true;
}

bool BrickBuffers::tint(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints) {
    gl_.glBindVertexArray(vertexArray_);
    const std::size_t records = records_.capacityBytes / sizeof(Record);
    isFresh_ = sentTints_.empty();
    if (!makeRoom(GL_ARRAY_BUFFER, tints_, records * sizeof(model::PieceTint))) {
        gl_.glBindVertexArray(0);
        untint();
        return false;
    }
    if (isFresh_)
        sentTints_.clear();
    sentTints_.resize(bricks_.size());
    std::vector<std::size_t> changed, drawn;
    for (std::size_t slot = 0; slot < bricks_.size(); ++slot) {
        const PictureBrick& brick = bricks_[slot];
        if (brick.indexCount == 0)
            continue;
        drawn.push_back(slot);
        SentTints sent{brick.version, brick.firstRecord, 1};
        for (const std::uint32_t piece : pieces.piecesOf(slot))
            sent.hash = (sent.hash ^ std::bit_cast<std::uint32_t>(tints[piece])) * 0x9e3779b97f4a7c15u;
        if (sent == sentTints_[slot])
            continue;
        sentTints_[slot] = sent;
        changed.push_back(slot);
    }
    if (5 * changed.size() > 4 * drawn.size()) { // as isMostlyNew()
        isFresh_ = true;
        changed.swap(drawn);
    }
    std::vector<model::PieceTint> colours;
    std::vector<std::pair<std::size_t, std::size_t>> brickStarts; // slot, place in `colours`
    for (const std::size_t slot : changed) {
        brickStarts.push_back({slot, colours.size()});
        addTints(pieces, slot, tints, colours);
    }
    std::vector<Stretch> stretches;
    for (const auto& [slot, start] : brickStarts)
        stretches.push_back({bricks_[slot].firstRecord, bricks_[slot].recordCount, &colours[start]});
    send(GL_ARRAY_BUFFER, tints_, sizeof(model::PieceTint), stretches);
    gl_.glBindBuffer(GL_ARRAY_BUFFER, tints_.name);
    gl_.glEnableVertexAttribArray(kTintLocation);
    gl_.glVertexAttribPointer(kTintLocation, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(model::PieceTint), nullptr);
    gl_.glBindVertexArray(0);
    return true;
}

void BrickBuffers::untint() {
    if (std::exchange(tints_.capacityBytes, 0) > 0)
        driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, tints_.name, 0);
    sentTints_.clear();
    gl_.glBindVertexArray(vertexArray_);
    gl_.glDisableVertexAttribArray(kTintLocation);
    gl_.glBindVertexArray(0);
}

// Then all of it goes in a few pieces, instead of most of it in two pieces a brick.
bool BrickBuffers::isMostlyNew(std::span<const extract::PictureBrick> now) const {
    std::size_t drawn = 0, changed = 0;
    for (std::size_t slot = 0; slot < now.size(); ++slot) {
        drawn += now[slot].indexCount > 0;
        changed += now[slot].indexCount > 0 && (slot >= bricks_.size() || now[slot] != bricks_[slot]);
    }
    return 5 * changed > 4 * drawn;
}

bool BrickBuffers::makeRoom(const Picture& picture) {
    const std::size_t places = (picture.recordEnd() + kRecordsPerPlace - 1) / kRecordsPerPlace;
    const std::size_t pagedPlaces = (places + kPage - 1) / kPage * kPage;
    return makeRoom(GL_COPY_WRITE_BUFFER, records_, picture.recordEnd() * sizeof(Record)) &&
           makeRoom(GL_COPY_WRITE_BUFFER, indices_, picture.indexEnd() * sizeof(std::uint16_t)) &&
           makeRoom(GL_COPY_WRITE_BUFFER, places_, pagedPlaces * sizeof(Place));
}

// What was in a buffer that grows is lost and sent again: that happens a few times in the life of a surface.
bool BrickBuffers::makeRoom(GLenum target, Buffer& buffer, std::size_t bytes) {
    if (bytes <= buffer.capacityBytes)
        return true;
    isFresh_ = true;
    buffer.capacityBytes = 1; // what it had is gone, whatever follows; not 0, so that freeMemory() frees it
    for (const std::size_t room : {bytes + bytes / 2, bytes}) {
        if (!driver_.allocate(gl_, target, buffer.name, room))
            continue;
        buffer.capacityBytes = room;
        return true;
    }
    return false;
}

void BrickBuffers::sendBytes(GLenum target, std::uint64_t at, std::size_t bytes, const void* data) {
    gl_.glBufferSubData(target, static_cast<GLintptr>(at), static_cast<GLsizeiptr>(bytes), data);
    uploadedBytes_ += bytes;
}

// Into a buffer that holds nothing yet many stretches go at once, with what lies between them.
void BrickBuffers::send(GLenum target, const Buffer& buffer, std::size_t elementBytes,
                        std::vector<Stretch>& stretches) {
    gl_.glBindBuffer(target, buffer.name);
    if (!isFresh_) {
        for (const Stretch& stretch : stretches)
            sendBytes(target, stretch.first * elementBytes, stretch.count * elementBytes, stretch.data);
        return;
    }
    std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) { return a.first < b.first; });
    std::vector<std::byte> together;
    for (std::size_t begin = 0, end = 0; begin < stretches.size(); begin = end) {
        const std::uint64_t first = stretches[begin].first;
        std::uint64_t last = first;
        for (; end < stretches.size(); ++end) {
            const std::uint64_t upTo = stretches[end].first + stretches[end].count;
            if (end > begin && (upTo - first) * elementBytes > kMostTogether)
                break;
            last = upTo;
        }
        together.resize((last - first) * elementBytes);
        for (std::size_t i = begin; i < end; ++i)
            std::memcpy(&together[(stretches[i].first - first) * elementBytes], stretches[i].data,
                        stretches[i].count * elementBytes);
        sendBytes(target, first * elementBytes, together.size(), together.data());
    }
}

void BrickBuffers::sendPlaces(std::vector<std::uint64_t>& pages) {
    gl_.glBindBuffer(GL_COPY_WRITE_BUFFER, places_.name);
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
    for (std::size_t begin = 0, end = 0; begin < pages.size(); begin = end) {
        end = begin + 1;
        while (end < pages.size() && pages[end] == pages[end - 1] + 1)
            ++end;
        const std::size_t first = pages[begin] * kPage,
                          last = std::min(placeTable_.size(), (pages[end - 1] + 1) * kPage);
        sendBytes(GL_COPY_WRITE_BUFFER, first * sizeof(Place), (last - first) * sizeof(Place), &placeTable_[first]);
    }
    gl_.glBindTexture(GL_TEXTURE_BUFFER, placesTexture_);
    gl_.glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA16UI, places_.name);
    gl_.glBindTexture(GL_TEXTURE_BUFFER, 0);
}

bool BrickBuffers::sendChanged(const Picture& picture) {
    const auto triangles = picture.changedTriangles();
    const auto indices = picture.changedIndices();
    changed_.assign(triangles.begin(), triangles.end());
    if (changed_.empty())
        return true;
    // Fresh storage each time: the driver need not wait for the draw that reads the old one.
    changedIndices_.capacityBytes = std::max(changedIndices_.capacityBytes, indices.size_bytes());
    if (!driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, changedIndices_.name, changedIndices_.capacityBytes)) {
        changedIndices_.capacityBytes = 0;
        return false;
    }
    sendBytes(GL_COPY_WRITE_BUFFER, 0, indices.size_bytes(), indices.data());
    return true;
}

bool BrickBuffers::drawSurface(const glm::dmat4& modelToClip, const std::function<bool()>& isStopped) {
    listInView(modelToClip, false);
    return drawParts(indices_.name, isStopped);
}

bool BrickBuffers::drawCoarse(const Picture& picture, int blockCells, const glm::dmat4& modelToClip,
                              const std::function<bool()>& isStopped) {
    coarsen(picture, blockCells);
    listInView(modelToClip, true);
    return drawParts(coarseIndices_.name, isStopped);
}

void BrickBuffers::coarsen(const Picture& picture, int blockCells) {
    if (std::exchange(coarseBlockCells_, blockCells) != blockCells)
        coarse_.clear();
    bool isOther = coarse_.size() != bricks_.size();
    coarse_.resize(bricks_.size());
    std::size_t count = 0;
    for (std::size_t slot = 0; slot < bricks_.size(); ++slot) {
        CoarseBrick& coarse = coarse_[slot];
        const PictureBrick& brick = bricks_[slot];
        if (coarse.of != brick) {
            isOther = true;
            coarse.of = brick;
            coarse.indices.clear();
            if (brick.indexCount > 0)
                coarsenBrick({picture.records(brick), brick.recordCount}, {picture.indices(brick), brick.indexCount},
                             blockCells, coarse.indices);
        }
        coarse.firstIndex = static_cast<std::uint32_t>(count);
        count += coarse.indices.size();
    }
    if (!isOther)
        return; // drawn again: from elsewhere, or for another layer of what is transparent
    std::vector<std::uint16_t> together;
    together.reserve(count);
    for (const CoarseBrick& coarse : coarse_)
        together.insert(together.end(), coarse.indices.begin(), coarse.indices.end());
    const std::size_t bytes = count * sizeof(std::uint16_t);
    coarseIndices_.capacityBytes = std::max(coarseIndices_.capacityBytes, bytes);
    if (bytes == 0)
        return;
    if (driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, coarseIndices_.name, coarseIndices_.capacityBytes))
        return sendBytes(GL_COPY_WRITE_BUFFER, 0, bytes, together.data());
    coarseIndices_.capacityBytes = 0; // then nothing of the draft is drawn
    coarse_.clear();
    coarse_.resize(bricks_.size());
}

bool BrickBuffers::drawParts(GLuint indices, const std::function<bool()>& isStopped) {
    if (!isStopped) {
        drawRange(indices, 0, counts_.size());
        return true;
    }
    for (std::size_t begin = 0, end = 0; begin < counts_.size(); begin = end) {
        std::size_t together = 0;
        for (; end < counts_.size() && together < kIndicesTogether; ++end)
            together += static_cast<std::size_t>(counts_[end]);
        drawRange(indices, begin, end);
        if (isStopped())
            return false;
    }
    return true;
}

// Nearest first: what is hidden fails the depth test before it is shaded.
void BrickBuffers::listInView(const glm::dmat4& modelToClip, bool isCoarse) {
    auto planes = viewPlanes(modelToClip);
    planes.insert(planes.end(), cuts_.begin(), cuts_.end());
    const glm::vec4 depth(modelToClip[0][3], modelToClip[1][3], modelToClip[2][3], 0.0); // w of a place
    const glm::vec4 along(modelToClip[0][2], modelToClip[1][2], modelToClip[2][2], 0.0); // z, for a parallel projection
    const bool isPerspective = glm::dot(depth, depth) > 0.0f;
    inView_.clear();
    for (std::size_t slot = 0; slot < bricks_.size(); ++slot) {
        const PictureBrick& brick = bricks_[slot];
        if (brick.indexCount == 0 || !isInView(brick, planes))
            continue;
        const glm::vec4 place(brick.place[0], brick.place[1], brick.place[2], 0.0);
        inView_.emplace_back(glm::dot(isPerspective ? depth : along, place), static_cast<std::uint32_t>(slot));
    }
    std::sort(inView_.begin(), inView_.end());
    counts_.clear();
    offsets_.clear();
    baseVertices_.clear();
    for (const auto& [_, slot] : inView_) {
        const PictureBrick& brick = bricks_[slot];
        const std::size_t first = isCoarse ? coarse_[slot].firstIndex : brick.firstIndex;
        counts_.push_back(static_cast<GLsizei>(isCoarse ? coarse_[slot].indices.size() : brick.indexCount));
        offsets_.push_back(reinterpret_cast<const void*>(first * sizeof(std::uint16_t)));
        baseVertices_.push_back(static_cast<GLint>(brick.firstRecord));
    }
}

void BrickBuffers::drawChanged() {
    counts_.clear();
    offsets_.clear();
    baseVertices_.clear();
    std::size_t first = 0;
    for (const extract::ChangedTriangles& changed : changed_) {
        counts_.push_back(static_cast<GLsizei>(changed.indexCount));
        offsets_.push_back(reinterpret_cast<const void*>(first * sizeof(std::uint16_t)));
        baseVertices_.push_back(static_cast<GLint>(bricks_[changed.slot].firstRecord));
        first += changed.indexCount;
    }
    drawRange(changedIndices_.name, 0, counts_.size());
}

void BrickBuffers::drawRange(GLuint indices, std::size_t begin, std::size_t end) {
    if (begin == end)
        return;
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glBindTexture(GL_TEXTURE_BUFFER, placesTexture_);
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
    gl_.glMultiDrawElementsBaseVertex(GL_TRIANGLES, &counts_[begin], GL_UNSIGNED_SHORT, &offsets_[begin],
                                      static_cast<GLsizei>(end - begin), &baseVertices_[begin]);
    gl_.glBindVertexArray(0);
    gl_.glBindTexture(GL_TEXTURE_BUFFER, 0);
}

} // namespace isoslider::render
