#include "core/base/read_conflict.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace isoslider {
namespace {

namespace fs = std::filesystem;

TEST(ReadConflict, IsFoundThroughLinksAndPartialNames) {
    const test::TemporaryFolder folder;
    const auto volume = folder.write("volume.mha", "samples");
    const auto other = folder.write("other.mha", "samples");
    fs::create_symlink(volume, folder / "link.ply");
    folder.write("mesh.ply.partial", "samples");
    EXPECT_EQ(conflictWith(volume, {other, volume}), ReadConflict::Itself);
    EXPECT_EQ(conflictWith(folder / "link.ply", {volume}), ReadConflict::Itself);
    EXPECT_EQ(conflictWith(folder / "mesh.ply", {folder / "mesh.ply.partial"}), ReadConflict::Partial);
    EXPECT_EQ(conflictWith(folder / "new.ply", {volume, other}), ReadConflict::None);
    EXPECT_EQ(conflictWith(volume, {}), ReadConflict::None);
}

TEST(ReadConflict, OfAFolderIsWithEachFileThatIsThere) {
    const test::TemporaryFolder folder;
    fs::create_directory(folder / "series");
    const auto slice = folder.write("series/slice.ply", "samples");
    EXPECT_EQ(conflictWithFolder(slice, folder / "series"), ReadConflict::Itself);
    EXPECT_EQ(conflictWithFolder(folder / "series" / "new.ply", folder / "series"), ReadConflict::None);
    EXPECT_EQ(conflictWithFolder(folder.write("beside.ply", "x"), folder / "series"), ReadConflict::None);
}

} // namespace
} // namespace isoslider
