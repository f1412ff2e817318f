#include "core/index/index_appendix.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/byte_codec.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {
namespace {

constexpr std::array<char, 8> kAppendixMagic{'I', 'S', 'O', 'A', 'P', 'P', 'E', 'N'};
constexpr std::size_t kHeaderBytes = 64;
constexpr std::uint64_t kMaxDirectoryBytes = std::uint64_t{1} << 32;

struct Header {
    std::uint64_t indexChecksum = 0; ///< of the preamble of the index that it belongs to
    std::uint64_t bodyBytes = 0, directoryBytes = 0, directoryChecksum = 0;
};

std::vector<std::byte> encode(const Header& header) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    out.putBytes(std::as_bytes(std::span(kAppendixMagic)));
    for (const std::uint64_t field : {header.indexChecksum, header.bodyBytes, header.directoryBytes,
                                      header.directoryChecksum, std::uint64_t{0}, std::uint64_t{0}})
        out.put<std::uint64_t>(field);
    out.put<std::uint64_t>(metaChecksum(bytes));
    return bytes;
}

std::optional<Header> decode(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    const auto magic = in.getBytes(kAppendixMagic.size());
    Header header;
    for (std::uint64_t* field :
         {&header.indexChecksum, &header.bodyBytes, &header.directoryBytes, &header.directoryChecksum})
        *field = in.get<std::uint64_t>();
    in.getBytes(16);
    if (in.get<std::uint64_t>() != metaChecksum(bytes.first(kHeaderBytes - 8)) ||
        !std::equal(magic.begin(), magic.end(), std::as_bytes(std::span(kAppendixMagic)).begin()))
        return std::nullopt;
    return header;
}

struct OpenIndex {
    std::unique_ptr<RandomAccessFile> file;
    std::uint64_t bytes = 0, checksum = 0; ///< of the index itself; of its preamble
};

Result<OpenIndex> openIndex(const std::filesystem::path& path, FileSystem& fileSystem) {
    auto file = fileSystem.openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    OpenIndex index;
    index.file = std::move(file).value();
    std::vector<std::byte> first(
        static_cast<std::size_t>(std::min<std::uint64_t>(index.file->sizeBytes(), kPreambleBytes)));
    ISO_TRY(index.file->readExactlyAt(0, first));
    const auto preamble = decodePreamble(first, index.file->sizeBytes(), path.string());
    if (!preamble.isOk())
        return preamble.error();
    index.bytes = preamble.value().fileBytes;
    ISO_TRY(checkBehindIndex(*index.file, index.bytes));
    index.checksum = loadLittle<std::uint64_t>(first.data() + kPreambleBytes - 8);
    return index;
}

} // namespace

Status checkBehindIndex(const RandomAccessFile& file, std::uint64_t indexBytes) {
    const std::uint64_t behind = file.sizeBytes() - indexBytes;
    if (behind == 0)
        return {};
    // The header is zeros until all else is written.
    std::vector<std::byte> first(static_cast<std::size_t>(std::min<std::uint64_t>(behind, kHeaderBytes)));
    ISO_TRY(file.readExactlyAt(indexBytes, first));
    const bool isUnfinished = std::all_of(first.begin(), first.end(), [](std::byte b) { return b == std::byte{0}; });
    const auto magic = std::as_bytes(std::span(kAppendixMagic));
    if (behind < kHeaderBytes || (!isUnfinished && !std::equal(magic.begin(), magic.end(), first.begin())))
        return makeError(ErrorCode::Corruption,
                         "index should have " + std::to_string(indexBytes) + " bytes, the file has " +
                             std::to_string(file.sizeBytes()),
                         file.path().string());
    return {};
}

Result<std::optional<Appendix>> readAppendix(const std::filesystem::path& path, FileSystem& fileSystem) {
    auto index = openIndex(path, fileSystem);
    if (!index.isOk())
        return std::move(index).error();
    const auto none = [] { return std::optional<Appendix>(); };
    RandomAccessFile& file = *index.value().file;
    const std::uint64_t start = index.value().bytes, behind = file.sizeBytes() - start;
    if (behind == 0)
        return none();
    std::vector<std::byte> bytes(kHeaderBytes);
    ISO_TRY(file.readExactlyAt(start, bytes));
    const auto header = decode(bytes);
    if (!header || header->indexChecksum != index.value().checksum || header->bodyBytes > behind - kHeaderBytes ||
        header->directoryBytes > behind - kHeaderBytes - header->bodyBytes ||
        header->directoryBytes > kMaxDirectoryBytes)
        return none();
    Appendix appendix;
    appendix.bodyOffset = start + kHeaderBytes;
    appendix.bodyBytes = header->bodyBytes;
    appendix.directory.resize(static_cast<std::size_t>(header->directoryBytes));
    ISO_TRY(file.readExactlyAt(appendix.bodyOffset + header->bodyBytes, appendix.directory));
    if (metaChecksum(appendix.directory) != header->directoryChecksum)
        return none();
    appendix.file = std::move(index.value().file);
    return std::optional<Appendix>(std::move(appendix));
}

Result<AppendixCheck> checkAppendix(const std::filesystem::path& path, FileSystem& fileSystem) {
    const auto appendix = readAppendix(path, fileSystem);
    if (!appendix.isOk())
        return appendix.error();
    if (appendix.value()) {
        const std::uint64_t end =
            appendix.value()->bodyOffset + appendix.value()->bodyBytes + appendix.value()->directory.size();
        const bool isLast = end == appendix.value()->file->sizeBytes();
        return AppendixCheck{isLast ? AppendixState::Whole : AppendixState::Followed, end};
    }
    const auto index = openIndex(path, fileSystem);
    if (!index.isOk())
        return index.error();
    const std::uint64_t end = index.value().bytes;
    if (index.value().file->sizeBytes() == end)
        return AppendixCheck{AppendixState::None, end};
    std::vector<std::byte> first(kHeaderBytes);
    ISO_TRY(index.value().file->readExactlyAt(end, first));
    const bool isUnfinished = std::all_of(first.begin(), first.end(), [](std::byte b) { return b == std::byte{0}; });
    return AppendixCheck{isUnfinished ? AppendixState::Unfinished : AppendixState::Damaged, end};
}

Status writeAppendix(const IndexReader& reader, std::size_t parts,
                     const std::function<Result<std::vector<std::byte>>(std::size_t)>& part,
                     std::span<const std::byte> directory, bool replaces, FileSystem& fileSystem) {
    const std::filesystem::path path = reader.pathString();
    const std::uint64_t start = reader.info().indexBytes;
    auto file = fileSystem.extend(path, reader.preambleBytes(), start);
    if (!file.isOk())
        return std::move(file).error();
    WritableFile& out = *file.value();
    if (!replaces) // a program that has just written one may be reading it
        if (const auto present = readAppendix(path); present.isOk() && present.value())
            return {};
    const auto write = [&]() -> Status {
        ISO_TRY(out.cut(start));
        // The header comes last: without it there is no appendix.
        ISO_TRY(out.writeAll(std::vector<std::byte>(kHeaderBytes)));
        std::uint64_t bodyBytes = 0;
        for (std::size_t i = 0; i < parts; ++i) {
            const auto bytes = part(i);
            if (!bytes.isOk())
                return bytes.error();
            ISO_TRY(out.writeAll(bytes.value()));
            bodyBytes += bytes.value().size();
        }
        ISO_TRY(out.writeAll(directory));
        ISO_TRY(out.sync());
        const auto checksum = loadLittle<std::uint64_t>(reader.preambleBytes().data() + kPreambleBytes - 8);
        ISO_TRY(out.writeAt(start, encode({checksum, bodyBytes, directory.size(), metaChecksum(directory)})));
        return out.sync();
    };
    Status status = write();
    if (!status.isOk())
        (void)out.cut(start); // or it is cut off the next time
    return status.isOk() ? out.close() : status;
}

} // namespace isoslider::index
