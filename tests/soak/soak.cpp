#include "tests/soak/soak.h"

#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include "app/desktop/preprocess_index_builder.h"
#include "tests/support/sanitizers.h"

namespace isoslider::test {
namespace fs = std::filesystem;
namespace {

constexpr int kSlides = 40, kJumps = 10;
constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

int entriesOf(const char* folder) {
    int count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder))
        ++count;
    return count;
}

std::uint64_t residentBytes() {
    std::uint64_t total = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t heapBytes() {
    if (kHasSanitizers) // which have an allocator of their own
        return 0;
    const auto use = ::mallinfo2();
    return use.uordblks + use.hblkhd;
}

template <class T>
fs::path writeVolume(const fs::path& path, const char* type, int x, int y, int z, T (*valueAt)(float, float, float)) {
    std::ofstream file(path, std::ios::binary);
    file << fmt::format(
        "ObjectType = Image\nNDims = 3\nDimSize = {} {} {}\nElementType = {}\nElementDataFile = LOCAL\n", x, y, z,
        type);
    for (int k = 0; k < z; ++k)
        for (int j = 0; j < y; ++j)
            for (int i = 0; i < x; ++i) {
                const auto part = [](int at, int count) { return static_cast<float>(at) / static_cast<float>(count); };
                const T value = valueAt(part(i, x), part(j, y), part(k, z));
                file.write(reinterpret_cast<const char*>(&value), sizeof value);
            }
    return path;
}

} // namespace

std::vector<fs::path> writeSoakVolumes(const fs::path& folder, int side) {
    return {writeVolume<std::uint8_t>(folder / "waves.mha", "MET_UCHAR", side, side, side / 2,
                                      [](float x, float y, float z) {
                                          const float wave = std::sin(20 * x) + std::sin(17 * y) + std::sin(9 * z);
                                          return static_cast<std::uint8_t>(127 + 40 * wave);
                                      }),
            writeVolume<std::uint16_t>(folder / "shells.mha", "MET_USHORT", side / 2, side, side,
                                       [](float x, float y, float z) {
                                           const float r = std::hypot(x - 0.5f, y - 0.5f, z - 0.5f);
                                           return static_cast<std::uint16_t>(2000 + 1500 * std::sin(30 * r));
                                       }),
            writeVolume<float>(folder / "slope.mha", "MET_FLOAT", side, side / 2, side,
                               [](float x, float y, float z) { return 3 * x + y * y + std::sin(40 * x * z); })};
}

// Pools keep what the largest volume took, and the allocator holes: hence some room above the first round.
std::string growthOf(const SoakRound& first, const SoakRound& later) {
    if (later.descriptors > first.descriptors)
        return fmt::format("{} descriptors are open, {} were after the first round", later.descriptors,
                           first.descriptors);
    if (later.threads > first.threads + 2) // the libraries start theirs when they are first needed
        return fmt::format("{} threads, {} after the first round", later.threads, first.threads);
    if (later.heapBytes > first.heapBytes + first.heapBytes / 20 + 2 * kMebibyte)
        return fmt::format("{} KiB in use, {} after the first round", later.heapBytes / 1024, first.heapBytes / 1024);
    if (!kHasSanitizers && later.residentBytes > first.residentBytes + first.residentBytes / 4 + 32 * kMebibyte)
        return fmt::format("{} KiB resident, {} after the first round", later.residentBytes / 1024,
                           first.residentBytes / 1024);
    return {};
}

Soak::Soak(fs::path folder, std::vector<fs::path> volumes, std::uint32_t seed)
    : folder_(std::move(folder)), volumes_(std::move(volumes)), random_(seed) {
    model::SessionServices services;
    services.postToMain = queue_.poster();
    services.indexBuilder = std::make_shared<desktop::PreprocessIndexBuilder>();
    services.cacheFolder = folder_ / "cache";
    idleDescriptors_ = entriesOf("/proc/self/fd");
    session_ = std::make_unique<model::Session>(std::move(services));
    subscription_ = session_->noticePosted().observe([this](const model::Notice& notice) {
        if (notice.severity == model::Notice::Severity::Error && problem_.empty())
            problem_ = notice.title + ": " + notice.detail;
    });
}

Soak::~Soak() = default;

Result<SoakRound> Soak::round() {
    const auto begin = std::chrono::steady_clock::now();
    moves_ = 0;
    for (std::size_t i = 0; i < volumes_.size(); ++i)
        ISO_TRY(visit(volumes_[i], static_cast<std::size_t>(rounds_) % volumes_.size() == i));
    // The slide worker lets go of a volume after the session has.
    ISO_TRY(waitFor("letting go of files", [&] { return entriesOf("/proc/self/fd") <= idleDescriptors_; }));
    ::malloc_trim(0);
    SoakRound done;
    done.number = ++rounds_;
    done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    done.moves = moves_;
    done.residentBytes = residentBytes();
    done.heapBytes = heapBytes();
    done.descriptors = entriesOf("/proc/self/fd");
    done.threads = entriesOf("/proc/self/task");
    return done;
}

Status Soak::visit(const fs::path& volume, bool isBuiltAgain) {
    if (isBuiltAgain)
        forgetIndexes();
    model::OpenRequest request;
    request.path = volume;
    session_->open(request);
    ISO_TRY(waitFor("opening " + volume.string(), [&] { return session_->frame() != nullptr; }));
    // As a user does, who does not wait for the index.
    const double min = session_->isovalue().min(), max = session_->isovalue().max();
    ISO_TRY(move(min + 0.4 * (max - min)));
    ISO_TRY(waitFor("the index of " + volume.string(), [&] { return session_->isSettled(); }));
    if (session_->indexState() != model::IndexState::Ready)
        return makeError(ErrorCode::IoError, "has no index: " + problem_, volume.string());
    for (int i = 0; i < kSlides; ++i)
        ISO_TRY(move(min + (0.3 + 0.4 * i / kSlides) * (max - min)));
    std::uniform_real_distribution<double> anywhere(min, max);
    for (int i = 0; i < kJumps; ++i)
        ISO_TRY(move(anywhere(random_)));
    ISO_TRY(move(min + 0.45 * (max - min)));
    ISO_TRY(exportMesh());
    session_->close();
    return waitFor("closing " + volume.string(), [&] { return session_->isSettled(); });
}

Status Soak::move(double isovalue) {
    ++moves_;
    session_->isovalue().request(isovalue);
    return waitFor("a move", [&] { return !session_->isovalue().isLagging() && !session_->isMoving(); });
}

Status Soak::exportMesh() {
    const fs::path mesh = folder_ / "surface.ply";
    session_->exportMesh(mesh, session_->datasetGeneration());
    ISO_TRY(waitFor("an export", [&] { return session_->isSettled(); }));
    if (!session_->certificate() || session_->certificate()->report.triangles == 0 || !fs::exists(mesh))
        return makeError(ErrorCode::IoError, "no mesh was written: " + problem_, mesh.string());
    fs::remove(mesh);
    return {};
}

Status Soak::waitFor(const std::string& what, const std::function<bool()>& isDone) {
    if (!queue_.runUntil([&] { return !problem_.empty() || isDone(); }))
        return makeError(ErrorCode::IoError, what + " never ends");
    return problem_.empty() ? Status() : Status(makeError(ErrorCode::IoError, what + ": " + problem_));
}

// Not in use: the session has closed what it had open.
void Soak::forgetIndexes() { fs::remove_all(folder_ / "cache"); }

} // namespace isoslider::test
