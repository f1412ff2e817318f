#include "core/volume_io/formats/dicom/dicom_folder.h"

#include <algorithm>
#include <array>

#include "core/base/folders.h"
#include "core/volume_io/formats/dicom/dicom_elements.h"
#include "core/volume_io/formats/format_readers.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxLookedAt = 256; ///< other files in a folder before it is none of DICOM

} // namespace

bool beginsAsDicom(const fs::path& path) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return false;
    std::array<std::byte, 512> buffer;
    const auto count = file.value()->readAt(0, buffer);
    return count.isOk() && looksLikeDicom(std::span(buffer).first(count.value()));
}

bool isDicom(const fs::path& path, std::span<const std::byte> start) {
    if (!isFolder(path))
        return looksLikeDicom(start);
    const auto files = listFiles(path, {kMaxDicomDepth, kMaxLookedAt});
    return files.isOk() && std::ranges::any_of(files.value(), beginsAsDicom);
}

} // namespace isoslider::io
