#include "app/cli/input_kind.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <system_error>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/index/format/index_format.h"

namespace isoslider::cli {
namespace {

Result<bool> hasIndexMagic(const std::filesystem::path& path) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    std::array<std::byte, sizeof(index::kIndexMagic)> head{};
    const auto count = file.value()->readAt(0, head);
    if (!count.isOk())
        return count.error();
    return std::memcmp(head.data(), index::kIndexMagic, head.size()) == 0;
}

} // namespace

Result<InputKind> sniffInput(const std::filesystem::path& path, const io::ReadOptions& options) {
    if (isFolder(path))
        return InputKind::Volume;
    const auto isIndex = hasIndexMagic(path);
    if (!isIndex.isOk())
        return isIndex.error();
    if (isIndex.value())
        return InputKind::Index;
    if (path.extension() != ".isx" || options.raw || io::openVolume(path, options).isOk())
        return InputKind::Volume;
    return InputKind::Index;
}

} // namespace isoslider::cli
