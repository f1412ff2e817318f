#include "core/base/content_hash.h"

#include <algorithm>
#include <new>
#include <vector>

#include <xxhash.h>

namespace isoslider {
namespace {

constexpr std::size_t kPieceBytes = 1u << 20;

} // namespace

struct ContentHash::State {
    XXH3_state_t* state = XXH3_createState();
    ~State() { XXH3_freeState(state); }
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
    if (state_->state == nullptr)
        throw std::bad_alloc();
    XXH3_64bits_reset(state_->state);
}

ContentHash::~ContentHash() = default;

void ContentHash::add(std::span<const std::byte> bytes) {
    XXH3_64bits_update(state_->state, bytes.data(), bytes.size());
}

std::uint64_t ContentHash::value() const { return XXH3_64bits_digest(state_->state); }

Result<std::uint64_t> hashFile(const std::filesystem::path& path, const JobControl& job, FileSystem& fileSystem) {
    const auto file = fileSystem.openForReading(path);
    if (!file.isOk())
        return file.error();
    std::vector<std::byte> piece(kPieceBytes);
    ContentHash hash;
    for (std::uint64_t offset = 0;;) {
        if (job.isStopRequested())
            return cancelledError();
        const auto read = file.value()->readAt(offset, piece);
        if (!read.isOk())
            return read.error();
        hash.add(std::span(piece).first(read.value()));
        offset += read.value();
        if (read.value() < piece.size())
            return hash.value();
        job.report(static_cast<double>(offset) / static_cast<double>(std::max(offset, file.value()->sizeBytes())),
                   "Comparing the file");
    }
}

} // namespace isoslider
