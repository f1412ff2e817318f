#include "core/index/level_store.h"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

#include "core/base/byte_codec.h"
#include "core/base/folders.h"
#include "core/index/format/totals_page.h"

namespace isoslider::index {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic = "ISOLEVEL";
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHeaderBytes = 88, kGroupHeaderBytes = 64, kTableEntryBytes = 16;
constexpr std::uint32_t kWorthwhile = 0, kNotWorthwhile = 1;
constexpr std::uint64_t kLeastFileBound = std::uint64_t{16} << 20;
constexpr std::uint64_t kLeftOnDisk = std::uint64_t{256} << 20; ///< free bytes that are not ours to take

struct GroupHeader {
    std::uint32_t level = 0, pages = 0;
    std::uint64_t index = 0, bodyBytes = 0, tableChecksum = 0;
    std::uint32_t state = kWorthwhile;
};

std::vector<std::byte> encodeHeader(const IndexReader& reader) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.putBytes(std::as_bytes(std::span(kMagic)));
    out.put<std::uint32_t>(kVersion);
    out.put<std::uint32_t>(0);
    out.putBytes(reader.preambleBytes());
    out.put<std::uint64_t>(metaChecksum(bytes));
    return bytes;
}

std::vector<std::byte> encode(const GroupHeader& header, std::uint64_t seed, std::uint64_t offset) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.put<std::uint32_t>(header.level);
    out.put<std::uint32_t>(header.pages);
    out.put<std::uint64_t>(header.index);
    out.put<std::uint64_t>(header.bodyBytes);
    out.put<std::uint64_t>(header.tableChecksum);
    out.put<std::uint32_t>(header.state);
    bytes.resize(kGroupHeaderBytes - sizeof(std::uint64_t));
    out.put<std::uint64_t>(pageChecksum(bytes, seed, offset));
    return bytes;
}

std::optional<GroupHeader> decode(std::span<const std::byte> bytes, std::uint64_t seed, std::uint64_t offset) {
    ByteReader in(bytes);
    GroupHeader header;
    header.level = in.get<std::uint32_t>();
    header.pages = in.get<std::uint32_t>();
    header.index = in.get<std::uint64_t>();
    header.bodyBytes = in.get<std::uint64_t>();
    header.tableChecksum = in.get<std::uint64_t>();
    header.state = in.get<std::uint32_t>();
    const auto covered = bytes.first(kGroupHeaderBytes - sizeof(std::uint64_t));
    if (loadLittle<std::uint64_t>(bytes.data() + covered.size()) != pageChecksum(covered, seed, offset))
        return std::nullopt;
    return header;
}

// Pages follow each other from `offset` on, `header.bodyBytes` in all.
std::optional<std::vector<StoredPage>> decodeTable(std::span<const std::byte> bytes, const GroupHeader& header,
                                                   std::uint64_t offset) {
    ByteReader in(bytes);
    std::vector<StoredPage> pages(header.pages);
    std::uint64_t left = header.bodyBytes;
    for (StoredPage& page : pages) {
        page.bytes = in.get<std::uint32_t>();
        page.totals = in.get<std::uint32_t>();
        page.checksum = in.get<std::uint64_t>();
        page.offset = offset;
        if (page.bytes > left || page.totals == 0 || page.totals > kMaxPageTotals ||
            page.bytes > mostBytesOfTotals(page.totals))
            return std::nullopt;
        left -= page.bytes;
        offset += page.bytes;
    }
    return left == 0 ? std::optional(std::move(pages)) : std::nullopt;
}

// Of a file that was cut off within its magic, too.
bool beginsLikeLevels(const RandomAccessFile& file) {
    std::vector<std::byte> first(static_cast<std::size_t>(std::min<std::uint64_t>(file.sizeBytes(), kMagic.size())));
    const auto magic = std::as_bytes(std::span(kMagic));
    return file.readExactlyAt(0, first).isOk() && std::equal(first.begin(), first.end(), magic.begin());
}

bool isIn(const GroupHeader& header, std::uint64_t blocks) {
    return header.level >= 1 && header.level <= kMaxGroupLevel && header.index < blocks >> header.level;
}

} // namespace

fs::path LevelStore::pathFor(const fs::path& index) {
    auto target = linkTarget(index);
    fs::path path = target.isOk() ? std::move(target).value() : index;
    return path += ".levels";
}

void LevelStore::discard(const fs::path& index, FileSystem& disk) {
    const fs::path path = pathFor(index);
    const auto present = disk.openForReading(path);
    if (present.isOk() && beginsLikeLevels(*present.value()))
        (void)disk.removeFile(path);
}

LevelStore::LevelStore(const IndexReader& reader, std::uint64_t memoryBytes)
    : reader_(reader),
      maxMemoryBytes_(memoryBytes),
      maxFileBytes_(std::max(reader.info().indexBytes / 2, kLeastFileBound)),
      seed_(loadLittle<std::uint64_t>(reader.preambleBytes().data() + kPreambleBytes - sizeof(std::uint64_t))),
      header_(encodeHeader(reader)) {
    if (!reader.disk()) {
        place_ = Place::Memory;
        return;
    }
    path_ = pathFor(reader.pathString());
    takeOver();
}

LevelStore::~LevelStore() = default;

void LevelStore::takeOver() {
    validBytes_ = kHeaderBytes;
    auto opened = reader_.disk()->openForReading(path_);
    if (!opened.isOk() || !isOfTheIndex(*opened.value()))
        return;
    readGroups(*opened.value());
    const std::lock_guard lock(mutex_);
    file_ = std::move(opened).value();
}

bool LevelStore::isOfTheIndex(const RandomAccessFile& file) const {
    std::vector<std::byte> first(kHeaderBytes);
    return file.readExactlyAt(0, first).isOk() && first == header_;
}

// From `validBytes_` on, as far as whole groups go. What follows is of a program that was ended while it wrote, or
// damaged, and is cut off before more is added.
void LevelStore::readGroups(const RandomAccessFile& file) {
    const auto& levels = reader_.meta().levels;
    const std::uint64_t blocks = levels.back().blocks.size();
    std::vector<std::byte> bytes(kGroupHeaderBytes), table;
    while (file.readExactlyAt(validBytes_, bytes).isOk()) {
        const auto header = decode(bytes, seed_, validBytes_);
        const std::uint64_t body = validBytes_ + kGroupHeaderBytes;
        const std::uint64_t left = std::max(file.sizeBytes(), body) - body;
        if (!header || !isIn(*header, blocks) || header->bodyBytes > left ||
            header->pages > (left - header->bodyBytes) / kTableEntryBytes)
            return;
        table.resize(header->pages * kTableEntryBytes);
        const std::uint64_t tableOffset = body + header->bodyBytes;
        if (!file.readExactlyAt(tableOffset, table).isOk() ||
            pageChecksum(table, seed_, tableOffset) != header->tableChecksum)
            return;
        auto pages = decodeTable(table, *header, body);
        if (!pages)
            return;
        auto group = std::make_shared<StoredGroup>();
        group->isWorthwhile = header->state == kWorthwhile;
        group->pages = std::move(*pages);
        const std::lock_guard lock(mutex_);
        for (StoredPage& page : group->pages)
            page.number = nextNumber_++;
        groups_[{static_cast<int>(header->level), header->index}] = std::move(group); // a later one is a better one
        validBytes_ = tableOffset + table.size();
    }
}

std::shared_ptr<const StoredGroup> LevelStore::find(const BlockGroup& group) const {
    const std::lock_guard lock(mutex_);
    const auto found = groups_.find(group);
    return found == groups_.end() ? nullptr : found->second;
}

Status LevelStore::read(const StoredPage& page, std::vector<std::byte>& bytes) const {
    if (page.memory) {
        bytes = *page.memory;
        return {};
    }
    std::shared_ptr<const RandomAccessFile> file;
    {
        const std::lock_guard lock(mutex_);
        file = file_;
    }
    if (!file)
        return makeError(ErrorCode::IoError, "is not there any more", path_);
    bytes.resize(page.bytes);
    ISO_TRY(file->readExactlyAt(page.offset, bytes));
    if (pageChecksum(bytes, seed_, page.offset) != page.checksum)
        return makeError(ErrorCode::Corruption, "page fails its checksum", path_, page.offset);
    return {};
}

void LevelStore::forget(const BlockGroup& group) {
    const std::lock_guard lock(mutex_);
    const auto found = groups_.find(group);
    if (found == groups_.end())
        return;
    for (const StoredPage& page : found->second->pages)
        memoryBytes_ -= page.memory ? page.memory->size() : 0;
    groups_.erase(found);
}

void LevelStore::dropMemory() {
    const std::lock_guard lock(mutex_);
    std::erase_if(groups_, [](const auto& entry) {
        return std::any_of(entry.second->pages.begin(), entry.second->pages.end(),
                           [](const StoredPage& page) { return page.memory != nullptr; });
    });
    memoryBytes_ = 0;
}

std::uint64_t LevelStore::memoryBytes() const {
    const std::lock_guard lock(mutex_);
    return memoryBytes_;
}

// Goes on with the file that was taken over, or makes one where there is none of use. What is no file of levels is
// somebody else's, and stays.
bool LevelStore::openWriter() {
    FileSystem& disk = *reader_.disk();
    const auto present = disk.openForReading(path_);
    const std::uint64_t knownBytes = validBytes_;
    bool isRight = false;
    if (present.isOk()) {
        if (!beginsLikeLevels(*present.value()))
            return false;
        isRight = isOfTheIndex(*present.value());
    } else if (present.error().code != ErrorCode::NotFound) {
        return false;
    }
    // Once the index is gone, nobody would remove what lies beside it.
    if (!isPresent(reader_.pathString()))
        return false;
    auto writer = isRight ? disk.extend(path_, header_, knownBytes) : disk.create(path_);
    if (!writer.isOk())
        return false;
    if (!isRight && !writer.value()->writeAll(header_).isOk())
        return false;
    // Another program may have added to it before this one held the lock.
    auto opened = disk.openForReading(path_);
    if (!opened.isOk())
        return false;
    if (!isRight)
        validBytes_ = kHeaderBytes;
    readGroups(*opened.value());
    if (!writer.value()->cut(validBytes_).isOk())
        return false;
    writer_ = std::move(writer).value();
    const std::lock_guard lock(mutex_);
    file_ = std::move(opened).value();
    return true;
}

// What has been written and can still be read stays in use; all else is kept in memory from now on.
void LevelStore::leaveFile() {
    writer_.reset();
    place_ = Place::Memory;
}

bool LevelStore::hasRoomInFile(std::uint64_t bytes) const {
    if (writer_->sizeBytes() + bytes > maxFileBytes_)
        return false;
    const auto space = reader_.disk()->space(path_.parent_path().empty() ? "." : path_.parent_path());
    return !space.isOk() || space.value().freeBytes > kLeftOnDisk;
}

bool LevelStore::begin() {
    draft_.clear();
    draftBytes_ = 0;
    if (place_ == Place::Undecided)
        place_ = openWriter() ? Place::File : Place::Memory;
    if (place_ == Place::Memory)
        return memoryBytes() < maxMemoryBytes_;
    if (!hasRoomInFile(kGroupHeaderBytes))
        return false;
    // Its header comes last: without it there is no group.
    if (!writer_->writeAll(std::vector<std::byte>(kGroupHeaderBytes)).isOk()) {
        abandon();
        leaveFile();
        return false;
    }
    return true;
}

bool LevelStore::add(std::span<const std::byte> bytes, std::uint32_t totals) {
    StoredPage page;
    page.bytes = static_cast<std::uint32_t>(bytes.size());
    page.totals = totals;
    draftBytes_ += bytes.size();
    if (place_ == Place::Memory) {
        if (memoryBytes() + draftBytes_ > maxMemoryBytes_)
            return false;
        page.memory = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
    } else {
        page.offset = writer_->sizeBytes();
        page.checksum = pageChecksum(bytes, seed_, page.offset);
        if (!hasRoomInFile(bytes.size()))
            return false;
        if (!writer_->writeAll(bytes).isOk()) {
            abandon();
            leaveFile();
            return false;
        }
    }
    draft_.push_back(std::move(page));
    return true;
}

void LevelStore::finish(const BlockGroup& group, bool isWorthwhile) {
    auto stored = std::make_shared<StoredGroup>();
    stored->isWorthwhile = isWorthwhile;
    if (place_ == Place::File) {
        std::vector<std::byte> table;
        ByteWriter out(table);
        for (const StoredPage& page : draft_) {
            out.put<std::uint32_t>(page.bytes);
            out.put<std::uint32_t>(page.totals);
            out.put<std::uint64_t>(page.checksum);
        }
        GroupHeader header;
        header.level = static_cast<std::uint32_t>(group.level);
        header.index = group.index;
        header.pages = static_cast<std::uint32_t>(draft_.size());
        header.bodyBytes = draftBytes_;
        header.tableChecksum = pageChecksum(table, seed_, writer_->sizeBytes());
        header.state = isWorthwhile ? kWorthwhile : kNotWorthwhile;
        Status written = writer_->writeAll(table);
        if (written.isOk())
            written = writer_->writeAt(validBytes_, encode(header, seed_, validBytes_));
        // Opened again: it is longer now. Gone where somebody has removed it.
        auto opened = reader_.disk()->openForReading(path_);
        if (!written.isOk() || !opened.isOk()) {
            abandon();
            leaveFile();
            return;
        }
        validBytes_ = writer_->sizeBytes();
        const std::lock_guard lock(mutex_);
        file_ = std::move(opened).value();
    }
    stored->pages = std::move(draft_);
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const StoredGroup>& place = groups_[group]; // what may fail comes first
    for (StoredPage& page : stored->pages) {
        page.number = nextNumber_++;
        memoryBytes_ += page.memory ? page.memory->size() : 0;
    }
    place = std::move(stored);
}

void LevelStore::abandon() noexcept {
    draft_.clear();
    if (!writer_)
        return;
    try {
        if (writer_->cut(validBytes_).isOk())
            return;
    } catch (const std::exception&) {}
    leaveFile(); // another program cuts it off
}

} // namespace isoslider::index
