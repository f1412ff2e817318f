#include "ui/model/opening/field_tree.h"

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

io::VolumeContents contentsOf(const char* format, std::initializer_list<const char*> names) {
    io::VolumeContents contents;
    contents.format = format;
    for (const char* name : names)
        contents.fields.emplace_back().name = name;
    return contents;
}

TEST(FieldTree, PutsFieldsIntoTheirGroups) {
    const FieldTree tree(contentsOf("HDF5", {"/mask", "/run1/density", "/run1/raw/v", "/run2/density", "/run1/late"}));
    EXPECT_TRUE(tree.hasGroups());
    const auto& root = tree.node(0);
    ASSERT_EQ(root.children.size(), 3u);
    EXPECT_EQ(tree.node(root.children[0]).name, "mask");
    EXPECT_EQ(tree.node(root.children[0]).field, 0u);
    const auto& run1 = tree.node(root.children[1]);
    EXPECT_EQ(run1.name, "run1");
    EXPECT_FALSE(run1.field);
    ASSERT_EQ(run1.children.size(), 3u);
    EXPECT_EQ(tree.node(run1.children[0]).name, "density");
    EXPECT_EQ(tree.node(run1.children[1]).name, "raw");
    EXPECT_EQ(tree.node(run1.children[2]).field, 4u) << "met again after another group";
    for (std::size_t field = 0; field < 5; ++field)
        EXPECT_EQ(tree.node(tree.nodeOf(field)).field, field);
    for (std::size_t i = 1; i < tree.size(); ++i)
        EXPECT_EQ(tree.node(tree.node(i).parent).children[tree.node(i).row], i);
}

TEST(FieldTree, WithoutGroupsIsAList) {
    for (const auto& contents : {contentsOf("HDF5", {"/a", "/b"}), contentsOf("VTK image", {"v m/s", "/x/y"}),
                                 contentsOf("DICOM", {"1.2.3", "1.2.3#1"})}) {
        const FieldTree tree(contents);
        EXPECT_FALSE(tree.hasGroups()) << contents.format;
        ASSERT_EQ(tree.node(0).children.size(), 2u);
    }
    EXPECT_EQ(FieldTree(contentsOf("VTK image", {"v m/s"})).node(1).name, "v m/s");
}

TEST(FieldTree, OddNamesHaveAPlace) {
    const FieldTree tree(contentsOf("NetCDF", {"", "/", "a//b", "a", "a/b"}));
    EXPECT_EQ(tree.node(tree.nodeOf(0)).name, "");
    EXPECT_EQ(tree.node(tree.nodeOf(1)).name, "/");
    EXPECT_EQ(tree.node(tree.nodeOf(2)).name, "b");
    EXPECT_EQ(tree.node(tree.nodeOf(3)).parent, 0u) << "beside the group of that name";
    EXPECT_EQ(tree.node(tree.nodeOf(4)).parent, tree.node(tree.nodeOf(2)).parent);
    EXPECT_EQ(FieldTree().size(), 1u);
}

} // namespace
} // namespace isoslider::model
