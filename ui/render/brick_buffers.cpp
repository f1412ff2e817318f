#include "ui/render/brick_buffers.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "ui/render/draw_parts.h"
#include "ui/render/tint_arrays.h"

namespace isoslider::render {
namespace {

using extract::PictureBrick;
using extract::VertexCode;

constexpr std::size_t kPage = 512; // places that are sent together
constexpr std::size_t kMostTogether = std::size_t{4} << 20; // bytes of a fresh buffer that are sent together

} // namespace

BrickBuffers::BrickBuffers(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {
    GLint most = 0;
    gl_.glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    mostPlaces_ = static_cast<std::uint64_t>(std::max(0, most));
    gl_.glGenVertexArrays(1, &vertexArray_);
    gl_.glGenTextures(1, &placesTexture_);
    gl_.glGenTextures(1, &innerTexture_);
    for (SizedBuffer* buffer : {&codes_, &indices_, &inner_, &places_, &changedIndices_, &tints_})
        buffer->name = driver_.makeBuffer(gl_);
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ARRAY_BUFFER, codes_.name);
    gl_.glEnableVertexAttribArray(0);
    gl_.glVertexAttribIPointer(0, 1, GL_UNSIGNED_SHORT, sizeof(VertexCode), nullptr);
    gl_.glBindVertexArray(0);
}

BrickBuffers::~BrickBuffers() {
    if (vertexArray_ == 0)
        return;
    freePages(0);
    for (const SizedBuffer* buffer : {&codes_, &indices_, &inner_, &places_, &changedIndices_, &tints_})
        driver_.freeBuffer(gl_, buffer->name);
    gl_.glDeleteTextures(1, &placesTexture_);
    gl_.glDeleteTextures(1, &innerTexture_);
    gl_.glDeleteVertexArrays(1, &vertexArray_);
}

void BrickBuffers::clear() {
    sentTints_.clear();
    bricks_.clear();
    changed_.clear();
    counts_.clear();
    series_ = 0;
}

void BrickBuffers::freePages(std::size_t first) {
    for (; pages_.size() > first; pages_.pop_back()) {
        driver_.freeBuffer(gl_, pages_.back().lines.name);
        gl_.glDeleteTextures(1, &pages_.back().scalars);
        gl_.glDeleteTextures(1, &pages_.back().normals);
    }
}

void BrickBuffers::freeMemory() {
    clear();
    freePages(0);
    for (SizedBuffer* buffer : {&codes_, &indices_, &inner_, &places_, &changedIndices_, &tints_})
        if (std::exchange(buffer->capacityBytes, 0) > 0)
            driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, buffer->name, 0);
}

bool BrickBuffers::canHold(const Picture& picture) const {
    const std::uint64_t lines = std::min<std::uint64_t>(picture.pointLineEnd(), kLinesPerPage);
    constexpr std::uint64_t kNormalsPerLine = sizeof(extract::PointLine) / sizeof(NormalCode);
    return picture.vertexEnd() / kVerticesPerPlace <= mostPlaces_ && picture.innerEnd() <= mostPlaces_ &&
           lines * std::max(kNormalsPerLine, sizeof(extract::PointLine) / scalarTypeSizeBytes(picture.type())) <=
               mostPlaces_;
}

bool BrickBuffers::upload(const Picture& picture) {
    if (picture.series() != series_)
        clear();
    isFresh_ = series_ == 0;
    gl_.glBindVertexArray(vertexArray_);
    if (!makeRoom(picture) || !makeRoomForPoints(picture)) {
        freeMemory();
        gl_.glBindVertexArray(0);
        return false;
    }
    const auto now = picture.bricks();
    isFresh_ = isFresh_ || isMostlyNew(now);
    if (series_ == 0)
        bricks_.clear();
    bricks_.resize(now.size());
    placeTable_.resize((picture.vertexEnd() + kVerticesPerPlace - 1) / kVerticesPerPlace);
    std::vector<Stretch> codes, indices, inner;
    std::vector<std::uint64_t> tablePages;
    for (std::size_t slot = 0; slot < now.size(); ++slot) {
        const PictureBrick& brick = now[slot];
        const PictureBrick before = std::exchange(bricks_[slot], brick);
        if (brick.indexCount == 0)
            continue;
        if (!isFresh_ && brick == before)
            continue;
        codes.push_back({brick.firstVertex, brick.vertexCount, picture.codes(brick)});
        indices.push_back({brick.firstIndex, brick.indexCount, picture.indices(brick)});
        if (brick.innerCount > 0)
            inner.push_back({brick.firstInner, brick.innerCount, picture.inner(brick)});
        const std::uint64_t first = brick.firstVertex / kVerticesPerPlace;
        const std::uint64_t last = (brick.firstVertex + std::uint64_t{brick.vertexCount} - 1) / kVerticesPerPlace;
        const Place place{brick.place[0] | std::uint32_t{brick.place[1]} << 16, brick.place[2],
                          brick.firstPointLine % kLinesPerPage, brick.firstInner};
        for (std::uint64_t entry = first; entry <= last; ++entry) {
            placeTable_[entry] = place;
            if (tablePages.empty() || tablePages.back() != entry / kPage)
                tablePages.push_back(entry / kPage);
        }
    }
    send(GL_COPY_WRITE_BUFFER, codes_, sizeof(extract::VertexCode), isFresh_, codes);
    send(GL_COPY_WRITE_BUFFER, indices_, sizeof(std::uint16_t), isFresh_, indices);
    send(GL_COPY_WRITE_BUFFER, inner_, sizeof(extract::InnerRecord), isFresh_, inner);
    sendPoints(picture);
    sendPlaces(tablePages);
    series_ = picture.series();
    const bool hasRoom = sendChanged(picture);
    gl_.glBindVertexArray(0);
    if (!hasRoom) // the surface without the marks is better than none
        changed_.clear();
    return true;
}

// Of a brick that was there before, and has kept its points, they are still in their place.
void BrickBuffers::sendPoints(const Picture& picture) {
    const std::uint32_t lines = extract::pointLineCount(scalarTypeSizeBytes(picture.type()));
    for (Page& page : pages_) {
        if (page.isFresh)
            page.versions.clear();
        page.versions.resize(kLinesPerPage / lines + 1, 0);
    }
    std::vector<std::vector<Stretch>> byPage(pages_.size());
    for (const PictureBrick& brick : bricks_) {
        if (brick.indexCount == 0)
            continue;
        const std::uint32_t first = brick.firstPointLine % kLinesPerPage;
        const std::uint32_t before = std::exchange(pages_[pageOf(brick)].versions[first / lines], brick.pointsVersion);
        if (before != brick.pointsVersion)
            byPage[pageOf(brick)].push_back({first, lines, picture.points(brick)});
    }
    for (std::size_t page = 0; page < pages_.size(); ++page)
        send(GL_COPY_WRITE_BUFFER, pages_[page].lines, sizeof(extract::PointLine),
             std::exchange(pages_[page].isFresh, false), byPage[page]);
}

void BrickBuffers::setUniforms(QOpenGLShaderProgram& program) const {
    program.setUniformValue("places", 0);
    program.setUniformValue("scalars", kBrickUnit);
    program.setUniformValue("normals", kBrickUnit + 1);
    program.setUniformValue("inner", kBrickUnit + 2);
    const auto bytes = static_cast<int>(scalarTypeSizeBytes(type_));
    const bool isSigned = type_ == ScalarType::I8 || type_ == ScalarType::I16;
    program.setUniformValue("scalarBytes", bytes);
    program.setUniformValue("zeroKey", isSigned ? 1 << (8 * bytes - 1) : 0);
}

bool BrickBuffers::tint(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints) {
    gl_.glBindVertexArray(vertexArray_);
    const std::size_t vertices = codes_.capacityBytes / sizeof(VertexCode);
    isFresh_ = sentTints_.empty();
    if (!makeRoom(GL_ARRAY_BUFFER, tints_, vertices * sizeof(model::PieceTint))) {
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
        SentTints sent{brick.version, brick.firstVertex, 1};
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
        stretches.push_back({bricks_[slot].firstVertex, bricks_[slot].vertexCount, &colours[start]});
    send(GL_ARRAY_BUFFER, tints_, sizeof(model::PieceTint), isFresh_, stretches);
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
    const std::size_t places = (picture.vertexEnd() + kVerticesPerPlace - 1) / kVerticesPerPlace;
    const std::size_t pagedPlaces = (places + kPage - 1) / kPage * kPage;
    // Never none: some drivers compile a program again, in 0.2 s, where a texture had no storage and gets some.
    const auto innerPlaces = std::max<std::size_t>(kPage, picture.innerEnd());
    return makeRoom(GL_COPY_WRITE_BUFFER, codes_, picture.vertexEnd() * sizeof(VertexCode)) &&
           makeRoom(GL_COPY_WRITE_BUFFER, indices_, picture.indexEnd() * sizeof(std::uint16_t)) &&
           makeRoom(GL_COPY_WRITE_BUFFER, inner_, innerPlaces * sizeof(extract::InnerRecord)) &&
           makeRoom(GL_COPY_WRITE_BUFFER, places_, pagedPlaces * sizeof(Place));
}

// Pages above what the picture has are given back.
bool BrickBuffers::makeRoomForPoints(const Picture& picture) {
    const bool isOther = series_ == 0 || std::exchange(type_, picture.type()) != picture.type();
    type_ = picture.type();
    const std::uint64_t end = picture.pointLineEnd();
    const std::size_t count = (end + kLinesPerPage - 1) / kLinesPerPage;
    freePages(count);
    for (std::size_t at = 0; at < count; ++at) {
        if (at == pages_.size()) {
            Page page;
            page.lines.name = driver_.makeBuffer(gl_);
            gl_.glGenTextures(1, &page.scalars);
            gl_.glGenTextures(1, &page.normals);
            pages_.push_back(page);
        }
        Page& page = pages_[at];
        const std::uint64_t lines = std::min<std::uint64_t>(kLinesPerPage, end - at * std::uint64_t{kLinesPerPage});
        const std::size_t bytes = lines * sizeof(extract::PointLine);
        const bool hasRoom = bytes <= page.lines.capacityBytes;
        const bool wasFresh = isFresh_;
        if (!makeRoom(GL_COPY_WRITE_BUFFER, page.lines, bytes))
            return false;
        isFresh_ = wasFresh; // of the other buffers
        page.isFresh = page.isFresh || isOther || !hasRoom;
        if (!page.isFresh)
            continue;
        constexpr std::array<GLenum, 5> kFormats{0, GL_R8UI, GL_R16UI, 0, GL_R32UI}; // by bytes of a sample
        gl_.glBindTexture(GL_TEXTURE_BUFFER, page.scalars);
        gl_.glTexBuffer(GL_TEXTURE_BUFFER, kFormats.at(scalarTypeSizeBytes(type_)), page.lines.name);
        gl_.glBindTexture(GL_TEXTURE_BUFFER, page.normals);
        gl_.glTexBuffer(GL_TEXTURE_BUFFER, GL_R16UI, page.lines.name);
    }
    gl_.glBindTexture(GL_TEXTURE_BUFFER, 0);
    return true;
}

// What was in a buffer that grows is lost and sent again: that happens a few times in the life of a surface.
bool BrickBuffers::makeRoom(GLenum target, SizedBuffer& buffer, std::size_t bytes) {
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
void BrickBuffers::send(GLenum target, const SizedBuffer& buffer, std::size_t elementBytes, bool isFresh,
                        std::vector<Stretch>& stretches) {
    gl_.glBindBuffer(target, buffer.name);
    if (!isFresh) {
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
    gl_.glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, places_.name);
    gl_.glBindTexture(GL_TEXTURE_BUFFER, innerTexture_);
    gl_.glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32UI, inner_.name);
    gl_.glBindTexture(GL_TEXTURE_BUFFER, 0);
}

bool BrickBuffers::sendChanged(const Picture& picture) {
    const auto triangles = picture.changedTriangles();
    const auto indices = picture.changedIndices();
    changed_.assign(triangles.begin(), triangles.end());
    if (changed_.empty())
        return true;
    if (!refill(gl_, driver_, GL_COPY_WRITE_BUFFER, changedIndices_, indices.data(), indices.size_bytes()))
        return false;
    uploadedBytes_ += indices.size_bytes();
    return true;
}

bool BrickBuffers::drawSurface(const glm::dmat4& modelToClip, std::span<const glm::dvec4> cuts,
                               const std::function<bool()>& isStopped) {
    listInView(modelToClip, cuts);
    clearCalls();
    for (const BrickInView& seen : inView_)
        addCall(bricks_[seen.slot], bricks_[seen.slot].firstIndex, bricks_[seen.slot].indexCount);
    if (!isStopped) {
        drawRange(indices_.name, 0, counts_.size());
        return true;
    }
    for (std::size_t begin = 0, end = 0; begin < counts_.size(); begin = end) {
        std::size_t together = 0;
        for (; end < counts_.size() && together < kIndicesTogether; ++end)
            together += static_cast<std::size_t>(counts_[end]);
        drawRange(indices_.name, begin, end);
        if (isStopped())
            return false;
    }
    return true;
}

// Nearest first, as far as pages allow: what is hidden fails the depth test before it is shaded.
void BrickBuffers::listInView(const glm::dmat4& modelToClip, std::span<const glm::dvec4> cuts) {
    listBricksInView(bricks_, modelToClip, cuts, inView_);
    std::sort(inView_.begin(), inView_.end(), [this](const BrickInView& a, const BrickInView& b) {
        return std::pair(pageOf(bricks_[a.slot]), a) < std::pair(pageOf(bricks_[b.slot]), b);
    });
}

void BrickBuffers::clearCalls() {
    callPages_.clear();
    counts_.clear();
    offsets_.clear();
    baseVertices_.clear();
}

void BrickBuffers::addCall(const PictureBrick& brick, std::size_t firstIndex, std::size_t count) {
    callPages_.push_back(pageOf(brick));
    counts_.push_back(static_cast<GLsizei>(count));
    offsets_.push_back(reinterpret_cast<const void*>(firstIndex * sizeof(std::uint16_t)));
    baseVertices_.push_back(static_cast<GLint>(brick.firstVertex));
}

void BrickBuffers::drawChanged() {
    clearCalls();
    std::size_t first = 0;
    for (const extract::ChangedTriangles& changed : changed_) {
        addCall(bricks_[changed.slot], first, changed.indexCount);
        first += changed.indexCount;
    }
    drawRange(changedIndices_.name, 0, counts_.size());
}

void BrickBuffers::bind(int unit, GLuint texture) {
    gl_.glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
    gl_.glBindTexture(GL_TEXTURE_BUFFER, texture);
}

void BrickBuffers::bindAll(GLuint indices) {
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
    bind(kBrickUnit + 2, innerTexture_);
    bind(0, placesTexture_);
}

void BrickBuffers::bindPage(std::size_t page) {
    bind(kBrickUnit, pages_[page].scalars);
    bind(kBrickUnit + 1, pages_[page].normals);
}

void BrickBuffers::unbindAll() {
    gl_.glBindVertexArray(0);
    for (const int unit : {kBrickUnit, kBrickUnit + 1, kBrickUnit + 2, 0})
        bind(unit, 0);
}

// One call for each stretch of bricks whose points are in one page.
void BrickBuffers::drawRange(GLuint indices, std::size_t begin, std::size_t end) {
    if (begin == end)
        return;
    bindAll(indices);
    for (std::size_t next = begin; begin < end; begin = next) {
        while (next < end && callPages_[next] == callPages_[begin])
            ++next;
        bindPage(callPages_[begin]);
        gl_.glMultiDrawElementsBaseVertex(GL_TRIANGLES, &counts_[begin], GL_UNSIGNED_SHORT, &offsets_[begin],
                                          static_cast<GLsizei>(next - begin), &baseVertices_[begin]);
    }
    unbindAll();
}

} // namespace isoslider::render
