#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_contents.h"
#include "core/volume_io/volume_reader.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/core/volume_io/volume_bytes.h"

// Sound files with a few bytes changed, left out or repeated: read or refused in one line, whatever they state.

namespace isoslider::io {
namespace {

using test::replaced;

struct Seed {
    const char* file;
    std::string bytes;
};

std::string text(int count) {
    std::string numbers;
    for (int i = 0; i < count; ++i)
        numbers += std::to_string(i) + " ";
    return numbers;
}

std::string mrc() {
    std::string bytes(1024, '\0');
    for (std::size_t i = 0; i < 3; ++i) {
        test::put<std::int32_t>(bytes, 4 * i, static_cast<std::int32_t>(4 - i));
        test::put<std::int32_t>(bytes, 28 + 4 * i, static_cast<std::int32_t>(4 - i));
        test::put<float>(bytes, 40 + 4 * i, 5.0f);
        test::put<float>(bytes, 52 + 4 * i, 80.0f);
        test::put<std::int32_t>(bytes, 64 + 4 * i, static_cast<std::int32_t>(i + 1));
    }
    test::put<std::int32_t>(bytes, 12, 1);
    std::memcpy(bytes.data() + 208, "MAP DD", 6);
    return bytes + test::ramp<std::int16_t>(24);
}

std::vector<Seed> seeds() {
    const std::string plain = test::ramp<std::int16_t>(24);
    const auto nrrd = [&](const std::string& encoding, const std::string& body) {
        return replaced(test::nrrdHeader(), "raw", encoding) + "\n" + body;
    };
    std::string series = test::niftiHeader();
    const std::int16_t dim[8] = {6, 2, 1, 1, 2, 3, 2, 1};
    std::memcpy(series.data() + 40, dim, sizeof dim);
    std::string vectors = replaced(test::nrrdHeader(), "domain domain domain", "domain 3-vector domain");
    vectors = replaced(vectors, "(0,2,0)", "none") + "\n" + plain;
    return {{"a.mha", test::mha()},
            {"a.mha", replaced(test::mhaHeader(), "BinaryData = True", "BinaryData = False") + text(24)},
            {"a.mha",
             replaced(test::mhaHeader(), "CompressedData = False", "CompressedData = True") + test::packed(plain, 15)},
            {"a.mhd", test::mhaHeader("LIST") + "half\nhalf\n"},
            {"a.mhd", test::mhaHeader("s%d.raw 1 2 1")},
            {"a.nrrd", test::nrrd()},
            {"a.nrrd", vectors},
            {"a.nrrd", nrrd("gzip", test::gzipped(plain))},
            {"a.nrrd", nrrd("bzip2", test::bzipped(plain))},
            {"a.nrrd", nrrd("hex", std::string(96, '7'))},
            {"a.nrrd", nrrd("ascii", text(24))},
            {"a.nhdr", test::nrrdHeader() + "data file: LIST 2\nhalf\nhalf\n"},
            {"a.nhdr", test::nrrdHeader() + "data file: s%d.raw 1 2 1 2\n"},
            {"a.nii", test::nifti()},
            {"a.nii", series + plain},
            {"a.nii.gz", test::gzipped(test::nifti())},
            {"a.mrc", mrc()},
            {"a.mrc.gz", test::gzipped(mrc())},
            {"a.cube", "a\nb\n-1 0 0 0\n4 1 0 0\n3 0 1 0\n2 0 0 1\n1 1 0 0 0\n1 7\n" + text(24)}};
}

std::string damaged(std::string bytes, std::mt19937_64& random) {
    const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
    for (std::size_t i = 0, changes = 1 + below(4); i < changes && bytes.size() > 1; ++i) {
        const std::size_t at = below(bytes.size());
        switch (below(6)) {
            case 0: bytes[at] = static_cast<char>(random()); break;
            case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
            case 2: bytes.erase(at, 1 + below(8)); break;
            case 3: bytes.insert(at, bytes, below(bytes.size()), 1 + below(16)); break;
            case 4: bytes.resize(at + 1); break;
            default: bytes[at] = "0123456789-.,% "[below(15)]; break;
        }
    }
    return bytes;
}

TEST(DamagedVolumes, AreReadOrRefusedInOneLine) {
    const std::uint64_t seed = std::random_device{}();
    RecordProperty("seed", std::to_string(seed));
    std::mt19937_64 random(seed);
    const test::TemporaryFolder folder;
    for (const char* name : {"half", "s1.raw", "s2.raw"})
        folder.write(name, test::ramp<std::int16_t>(12));
    int refused = 0, read = 0;
    for (const Seed& sound : seeds()) {
        ASSERT_THAT(listVolumes(folder.write(sound.file, sound.bytes)), test::IsOk()) << sound.bytes;
        for (int round = 0; round < 300; ++round) {
            const std::string bytes = damaged(sound.bytes, random);
            std::filesystem::remove(folder / sound.file); // writing over it would wait for the disk
            const auto path = folder.write(sound.file, bytes);
            SCOPED_TRACE("seed " + std::to_string(seed) + ", " + sound.file + ", round " + std::to_string(round));
            const auto contents = listVolumes(path);
            ReadOptions options;
            options.allowsTrailing = round % 3 == 0;
            if (contents.isOk() && contents.value().needsChoice()) {
                options.frame = contents.value().fields[0].frames - 1;
                options.component = round % 2 == 0 ? contents.value().fields[0].components - 1 : kMagnitude;
            }
            const auto grid = readVolume(path, options);
            grid.isOk() ? ++read : ++refused;
            if (!grid.isOk()) {
                ASSERT_THAT(grid.error().line(), testing::Not(testing::HasSubstr("\n")));
            }
        }
    }
    EXPECT_GT(refused, 100);
    EXPECT_GT(read, 100);
}

} // namespace
} // namespace isoslider::io
