#include "ui/model/recent_file.h"

#include <random>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

RecentFile everything() {
    RecentFile file;
    file.path = "/data/überflow \"x\".nc";
    file.options.field = "speed, of=wind";
    file.options.component = io::kMagnitude;
    file.options.frame = 3;
    file.options.resampleDims = {50, 80, 40};
    file.options.allowsTrailing = true;
    file.options.raw = io::RawLayout{{40, 36, 28}, ScalarType::U16, glm::dvec3(1.0, 0.1, 2.5e-7), 512, true};
    file.fieldTitle = "Wind speed";
    return file;
}

TEST(RecentFile, GivesBackWhatItTook) {
    const RecentFile file = everything(), back = recentFromText(recentText(file));
    EXPECT_TRUE(back.isSameAs(file));
    EXPECT_EQ(back.fieldTitle, file.fieldTitle);
    const RecentFile plain{"/a/b=c.mha", {}, {}};
    EXPECT_EQ(recentText(plain), "/a/b=c.mha") << "as earlier versions kept it";
    EXPECT_TRUE(recentFromText("/a/b=c.mha").isSameAs(plain));
}

TEST(RecentFile, DamagedChoicesReadAsNone) {
    for (const char* text : {"frame=-1", "frame=3x", "frame=", "component=-2", "component=big", "size=1x2", "size=1x2x3x4",
                             "size=0x2x2", "size=2x2x9999999999", "raw=", "raw=2x2x2,u8,little,0,1,1",
                             "raw=2x2x2,u9,little,0,1,1,1", "raw=2x2x2,u8,middle,0,1,1,1", "raw=2x2x2,u8,big,-1,1,1,1",
                             "raw=2x2x2,u8,big,0,nan,1,1", "raw=2x2x2,u8,big,0,1,0,1", "trailing=maybe", "later=1", "frame", ""}) {
        const RecentFile file = recentFromText("/a.nc\x1f" "field=v\x1f" + std::string(text));
        EXPECT_EQ(file.path, "/a.nc") << text;
        EXPECT_FALSE(file.hasChoices()) << text;
    }
    std::mt19937 random(7);
    const std::string whole = recentText(everything());
    for (int round = 0; round < 2000; ++round) {
        std::string damaged = whole;
        damaged[random() % damaged.size()] = static_cast<char>(random());
        const RecentFile file = recentFromText(damaged.substr(0, random() % (damaged.size() + 1)));
        if (file.options.component) {
            EXPECT_GE(*file.options.component, io::kMagnitude);
        }
        if (file.options.frame) {
            EXPECT_GE(*file.options.frame, 0);
        }
    }
}

TEST(RecentFile, TellsWhatWasChosen) {
    RecentFile file;
    EXPECT_EQ(choicesText(file), "");
    file.options.field = "1.2.840";
    file.options.frame = 3;
    EXPECT_EQ(choicesText(file), "1.2.840, frame 3");
    file.fieldTitle = "T1 sagittal";
    EXPECT_EQ(choicesText(file), "T1 sagittal, frame 3");
    EXPECT_EQ(choicesText(everything()), "Wind speed, magnitude, frame 3, resampled to 50x80x40, 40x36x28 u16");
}

TEST(RecentFile, OfADatasetKeepsWhatOpensItAgain) {
    Dataset dataset;
    dataset.path = "/a.nc";
    dataset.readOptions = everything().options;
    dataset.readOptions.allowsExternalData = true;
    dataset.fieldTitle = "Wind speed";
    EXPECT_TRUE(recentOf(dataset).isSameAs({"/a.nc", everything().options, {}}));
    EXPECT_EQ(recentOf(dataset).fieldTitle, "Wind speed");
    dataset.readOptions.field = "a\x1f" "frame=7";
    EXPECT_FALSE(recentOf(dataset).hasChoices()) << "this name would be taken apart";
}

} // namespace
} // namespace isoslider::model
