#include "ui/model/session/saved_colouring.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"
#include "ui/model/session/saved_session.h"

namespace isoslider::model {
namespace {

using Json = nlohmann::json;

Colouring byField(const std::filesystem::path& path) {
    Colouring colouring;
    colouring.by = ColourBy::Field;
    colouring.field = FieldFile{path, {}};
    colouring.field->options.field = "pressure";
    colouring.map = ColourMap::Cividis;
    colouring.isReversed = true;
    colouring.range = ColourRange{-1.5, 1e6};
    return colouring;
}

TEST(SavedColouring, GoesThereAndBack) {
    SavedSession session;
    session.volume = "/data/flow.vti";
    session.view.emplace();
    session.view->showsColourBar = false;
    for (const ColourBy by : kColourKeys) {
        session.view->colouring = by == ColourBy::Field ? byField("/data/other/p.vti") : Colouring{};
        session.view->colouring.by = by;
        const auto read = sessionFromText(sessionText(session, "/data"), "/data");
        EXPECT_TRUE(read.problems.empty()) << read.problems[0];
        EXPECT_EQ(read.session.view, session.view);
    }
}

TEST(SavedColouring, FindsAFieldThatMovedAlongWithIt) {
    const test::TemporaryFolder before, after;
    const Json json = colouringJson(byField(before.write("p.mha", "x")), before.path());
    const auto moved = after.write("p.mha", "x");
    std::vector<std::string> problems;
    EXPECT_EQ(colouringFromJson(json, after.path(), problems).field->path, moved);
    EXPECT_TRUE(problems.empty());
}

TEST(SavedColouring, WhatCannotBeUsedIsNamedAndTheRestStays) {
    const auto problemsOf = [](const char* text, Colouring& colouring) {
        std::vector<std::string> problems;
        colouring = colouringFromJson(Json::parse(text), "/data", problems);
        return problems;
    };
    Colouring colouring;
    for (const char* text :
         {"7", R"({"by": 3})", R"({"by": "w"})", R"({"map": "jet"})", R"({"reversed": 1})", R"({"range": [2, 1]})",
          R"({"range": [1]})", R"({"range": [null, 2]})", R"({"field": {}})", R"({"field": {"path": 8}})",
          R"({"field": {"path": "/a", "options": {"frame": -1}}})", R"({"what": 1})"}) {
        EXPECT_EQ(problemsOf(text, colouring).size(), 1u) << text;
        EXPECT_EQ(colouring, Colouring()) << text;
    }
    EXPECT_TRUE(problemsOf(R"({"by": "field"})", colouring).empty());
    EXPECT_EQ(colouring.by, ColourBy::One) << "without a file there is nothing to colour by";
    EXPECT_EQ(problemsOf(R"({"by": "y", "map": "jet", "range": [1, 2]})", colouring).size(), 1u);
    EXPECT_EQ(colouring.by, ColourBy::Y);
    EXPECT_EQ(colouring.range, (ColourRange{1.0, 2.0}));
}

} // namespace
} // namespace isoslider::model
