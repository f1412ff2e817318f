#include "ui/model/session/saved_surfaces.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "ui/model/session/saved_session.h"

namespace isoslider::model {
namespace {

using Json = nlohmann::json;

SurfaceList skinAndBone() {
    SurfaceList list;
    list.surfaces = {{SurfaceId{1}, "Skin \xc3\xa4", -300.25, {1, 171, 255}, 0.35, true, {}},
                     {SurfaceId{2}, "Bone", 1150.0, {230, 217, 193}, 1.0, false, {}}};
    list.active = SurfaceId{2};
    return list;
}

TEST(SavedSurfaces, GoThereAndBack) {
    SavedSession session;
    session.volume = "/data/head.mha";
    session.isovalue = 1150.0;
    session.surfaces = skinAndBone();
    const auto read = sessionFromText(sessionText(session, "/data"), "/data");
    EXPECT_TRUE(read.problems.empty()) << read.problems[0];
    EXPECT_EQ(read.session.surfaces, skinAndBone());
}

TEST(SavedSurfaces, ThoseThatDoNotSlideStateWhatTheyHide) {
    SurfaceList list = skinAndBone();
    HiddenPieces& hidden = list.surfaces[0].hiddenPieces;
    hidden.leastSize = 2.5;
    hidden.leastPersistence = 12.5;
    hidden.largest = 3;
    hidden.awaited.hidden = {{{1, 2, 3}, 0}, {{4, 5, 6}, 2}};
    hidden.awaited.only = PiecePlace{{7, 8, 9}, 1};
    list.surfaces[1].hiddenPieces.largest = 2;
    std::vector<std::string> problems;
    const auto read = surfacesFromJson(surfacesJson(list), problems);
    EXPECT_TRUE(problems.empty()) << problems[0];
    EXPECT_EQ(read.surfaces[0].hiddenPieces, hidden);
    EXPECT_EQ(read.surfaces[1].hiddenPieces, HiddenPieces()) << "of the active one the view states it";
    surfacesFromJson(Json::parse(R"({"list": [{"isovalue": 4, "pieces": {"hiddenPieces": [[1, 2]]}}]})"), problems);
    EXPECT_EQ(problems.size(), 1u);
    const auto negative = surfacesFromJson(
        Json::parse(R"({"list": [{"isovalue": 4, "pieces": {"leastPiecePersistence": -1}}]})"), problems);
    EXPECT_EQ(problems.size(), 2u);
    EXPECT_EQ(negative.surfaces[0].hiddenPieces.leastPersistence, 0.0);
}

TEST(SavedSurfaces, SessionsOfBeforeHaveNone) {
    const auto read =
        sessionFromText(R"({"isosliderSession": 1, "volume": {"path": "/data/head.mha"}, "isovalue": 5})", "/data");
    EXPECT_TRUE(read.problems.empty()) << read.problems[0];
    EXPECT_TRUE(read.session.surfaces.surfaces.empty());
    EXPECT_EQ(read.session.isovalue, 5.0);
}

TEST(SavedSurfaces, WhatCannotBeUsedIsNamedAndTheRestStays) {
    const auto read = [](const char* text, std::vector<std::string>& problems) {
        problems.clear();
        return surfacesFromJson(Json::parse(text), problems);
    };
    std::vector<std::string> problems;
    for (const char* text : {"3", "{}", R"({"list": []})", R"({"list": {"isovalue": 3}})"}) {
        EXPECT_TRUE(read(text, problems).surfaces.empty()) << text;
        EXPECT_EQ(problems.size(), 1u) << text;
    }
    auto list = read(R"({"list": [{"name": "x"}, 7, {"isovalue": null}, {"isovalue": 4}], "active": 1})", problems);
    ASSERT_EQ(list.surfaces.size(), 1u);
    EXPECT_EQ(problems.size(), 3u);
    EXPECT_EQ(list.surfaces[0].isovalue, 4.0);
    EXPECT_EQ(list.active, list.surfaces[0].id);
    list = read(R"({"list": [{"isovalue": 4, "opacity": 0, "colour": "red", "visible": 1, "name": 8}], "active": -1})",
                problems);
    ASSERT_EQ(list.surfaces.size(), 1u);
    EXPECT_EQ(problems.size(), 4u);
    EXPECT_EQ(list.surfaces[0].opacity, 1.0);
    EXPECT_EQ(list.surfaces[0].colour, ListedSurface().colour);
    EXPECT_TRUE(list.surfaces[0].isVisible);
    Json many{{"list", Json::array()}};
    for (std::size_t i = 0; i <= kMostSurfaces; ++i)
        many["list"].push_back({{"isovalue", i}});
    EXPECT_TRUE(surfacesFromJson(many, problems).surfaces.empty());
}

} // namespace
} // namespace isoslider::model
