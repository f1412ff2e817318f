#include "ui/model/session/recent_file.h"

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
    const std::string whole = recentText(everything());
    for (const auto& [from, to] : {std::pair("\"frame\":3", "\"frame\":-1"),
                                   {"\"frame\":3", "\"frame\":\"x\""},
                                   {"\"component\":-1", "\"component\":-2"},
                                   {"[50,80,40]", "[50,80]"},
                                   {"[50,80,40]", "[50,80,9999999999]"},
                                   {"\"u16\"", "\"u9\""},
                                   {"[40,36,28]", "[]"},
                                   {"[1.0,", "[0.0,"},
                                   {"\"skipBytes\":512", "\"skipBytes\":-1"},
                                   {"\"field\"", "\"later\""},
                                   {"{", ""},
                                   {"\x1fWind", "Wind"}}) {
        std::string damaged = whole;
        const auto place = damaged.find(from);
        ASSERT_NE(place, std::string::npos) << from << " in " << whole;
        const RecentFile file = recentFromText(damaged.replace(place, std::string(from).size(), to));
        EXPECT_EQ(file.path, everything().path) << from;
        EXPECT_FALSE(file.hasChoices()) << damaged;
    }
    std::mt19937 random(7);
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
    dataset.readOptions.field = "a\x1f"
                                "frame=7"; // no name can be taken apart
    EXPECT_TRUE(recentFromText(recentText(recentOf(dataset))).isSameAs(recentOf(dataset)));
}

} // namespace
} // namespace isoslider::model
