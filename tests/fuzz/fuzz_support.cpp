#include "tests/fuzz/fuzz_support.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace isoslider::fuzz {
namespace fs = std::filesystem;
namespace {

// A crash leaves its folder behind, with the one input in it.
class InputFolder {
public:
    InputFolder() {
        const fs::path memory = "/dev/shm";
        std::string name =
            ((::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path()) / "isoslider-fuzz-XXXXXX")
                .string();
        ISO_REQUIRE(::mkdtemp(name.data()) != nullptr, name);
        path_ = name;
    }
    ~InputFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    InputFolder(const InputFolder&) = delete;
    InputFolder& operator=(const InputFolder&) = delete;

    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

} // namespace

void broken(const char* promise, std::string_view detail, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: broken promise: %s: \"%.*s\"\n", file, line, promise, static_cast<int>(detail.size()),
                 detail.data());
    std::abort();
}

void requireLine(std::string_view text) {
    ISO_REQUIRE(!text.empty(), text);
    ISO_REQUIRE(std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= ' ' && c != '\x7f'; }), text);
}

void requireGoodError(const Error& error) {
    ISO_REQUIRE(!error.message.empty(), error.line());
    requireLine(error.line());
}

void requireGoodGeometry(const GridGeometry& geometry) {
    for (int axis = 0; axis < 3; ++axis) {
        ISO_REQUIRE(geometry.dims[axis] >= 1, std::to_string(geometry.dims[axis]));
        ISO_REQUIRE(std::isfinite(geometry.spacing[axis]) && geometry.spacing[axis] > 0.0,
                    std::to_string(geometry.spacing[axis]));
        ISO_REQUIRE(std::isfinite(geometry.origin[axis]), std::to_string(geometry.origin[axis]));
        for (int row = 0; row < 3; ++row)
            ISO_REQUIRE(std::isfinite(geometry.direction[axis][row]), std::to_string(geometry.direction[axis][row]));
    }
}

Result<std::size_t> BytesFile::readAt(std::uint64_t offset, std::span<std::byte> out) const {
    if (offset >= bytes_.size())
        return std::size_t{0};
    const auto part = bytes_.subspan(offset, std::min<std::uint64_t>(out.size(), bytes_.size() - offset));
    std::copy(part.begin(), part.end(), out.begin());
    return part.size();
}

fs::path writeInput(std::string_view name, std::span<const std::byte> bytes) {
    static const InputFolder folder;
    fs::path path = folder.path() / name;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    ISO_REQUIRE(file.flush().good(), path.string());
    return path;
}

} // namespace isoslider::fuzz
