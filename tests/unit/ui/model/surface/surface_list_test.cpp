#include "ui/model/surface/surface_list.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

class SurfacesModelTest : public ::testing::Test {
protected:
    SurfacesModelTest() {
        surfaces_.begin(10.0);
        subscription_ = surfaces_.observe([this] { ++notified_; });
    }
    const std::vector<ListedSurface>& all() { return surfaces_.list().surfaces; }

    SurfacesModel surfaces_;
    int notified_ = 0;
    Subscription subscription_;
};

TEST_F(SurfacesModelTest, BeginsWithOneOpaqueSurfaceThatStays) {
    ASSERT_EQ(all().size(), 1u);
    EXPECT_EQ(surfaces_.active(), &all()[0]);
    EXPECT_EQ(all()[0].isovalue, 10.0);
    EXPECT_EQ(all()[0].colour, kSurfaceColours[0].colour);
    EXPECT_EQ(all()[0].opacity, 1.0);
    EXPECT_FALSE(surfaces_.canRemove());
    surfaces_.remove(all()[0].id);
    EXPECT_EQ(all().size(), 1u);
    EXPECT_EQ(notified_, 0);
}

TEST_F(SurfacesModelTest, AnAddedSurfaceIsActiveAndApartFromTheOthers) {
    while (surfaces_.canAdd())
        surfaces_.add(20.0);
    EXPECT_EQ(all().size(), kMostSurfaces);
    EXPECT_EQ(surfaces_.active(), &all().back());
    std::set<SurfaceId> ids;
    std::set<std::string> names;
    std::set<SurfaceColour> colours;
    for (const ListedSurface& surface : all()) {
        ids.insert(surface.id);
        names.insert(surface.name);
        colours.insert(surface.colour);
    }
    EXPECT_EQ(ids.size(), kMostSurfaces);
    EXPECT_EQ(names.size(), kMostSurfaces);
    EXPECT_EQ(colours.size(), kSurfaceColours.size());
    surfaces_.add(30.0);
    EXPECT_EQ(all().size(), kMostSurfaces);
}

TEST_F(SurfacesModelTest, WhatWouldHideAnotherIsSeeThrough) {
    surfaces_.add(20.0); // inside
    EXPECT_EQ(all()[0].opacity, kSeeThroughOpacity);
    EXPECT_EQ(all()[1].opacity, 1.0);
    surfaces_.add(5.0); // around both
    EXPECT_EQ(all()[2].opacity, kSeeThroughOpacity);
    surfaces_.change(all()[0].id, [](ListedSurface& surface) { surface.opacity = 0.7; });
    surfaces_.add(30.0);
    EXPECT_EQ(all()[0].opacity, 0.7) << "what was chosen stays";
}

TEST_F(SurfacesModelTest, TheNextOneTakesThePlaceOfTheActiveOneThatIsRemoved) {
    surfaces_.add(20.0);
    surfaces_.add(30.0);
    const auto first = all()[0].id, second = all()[1].id, third = all()[2].id;
    surfaces_.activate(second);
    surfaces_.remove(second);
    EXPECT_EQ(surfaces_.list().active, third);
    surfaces_.remove(third);
    EXPECT_EQ(surfaces_.list().active, first);
    surfaces_.add(40.0);
    EXPECT_NE(all().back().id, second);
    EXPECT_NE(all().back().id, third) << "no id is given twice";
    surfaces_.activate(third);
    EXPECT_EQ(surfaces_.list().active, all().back().id) << "it is gone";
}

TEST_F(SurfacesModelTest, TheListIsARing) {
    surfaces_.add(20.0);
    surfaces_.add(30.0);
    surfaces_.activateNext(1);
    EXPECT_EQ(surfaces_.list().active, all()[0].id);
    surfaces_.activateNext(-1);
    EXPECT_EQ(surfaces_.list().active, all()[2].id);
    surfaces_.activateNext(-1);
    EXPECT_EQ(surfaces_.list().active, all()[1].id);
}

TEST_F(SurfacesModelTest, NotifiesOfChangesOnlyAndBeforeSurfacesComeAndGo) {
    int restructured = 0;
    std::size_t before = 0;
    const auto subscription = surfaces_.observeRestructuring([&] {
        ++restructured;
        before = all().size();
    });
    surfaces_.setIsovalue(10.0);
    EXPECT_EQ(notified_, 0);
    surfaces_.setIsovalue(11.0);
    EXPECT_EQ(notified_, 1);
    EXPECT_EQ(restructured, 0);
    surfaces_.add(20.0);
    EXPECT_EQ(restructured, 1);
    EXPECT_EQ(before, 1u) << "told before";
    surfaces_.activate(surfaces_.list().active);
    EXPECT_EQ(restructured, 1);
    EXPECT_EQ(notified_, 2);
}

TEST_F(SurfacesModelTest, RepairsWhatItIsGivenAndRefusesWhatItCannot) {
    SurfaceList list = surfaces_.list();
    list.surfaces[0].opacity = std::numeric_limits<double>::quiet_NaN();
    list.surfaces[0].name = std::string(kMostSurfaceNameBytes + 1, 'x');
    surfaces_.setList(list);
    EXPECT_EQ(all()[0].opacity, kLeastOpacity);
    EXPECT_TRUE(all()[0].name.empty());
    const SurfaceList good = surfaces_.list();
    auto without = good;
    without.surfaces.clear();
    auto twice = good;
    twice.surfaces.push_back(twice.surfaces[0]);
    auto inactive = good;
    inactive.active = SurfaceId{77};
    for (const SurfaceList& bad : {without, twice, inactive}) {
        surfaces_.setList(bad);
        EXPECT_EQ(surfaces_.list(), good);
    }
}

TEST_F(SurfacesModelTest, ARestoredListHasIdsOfItsOwn) {
    surfaces_.add(20.0);
    SurfaceList list = surfaces_.list();
    list.surfaces[0].name = "Skin";
    list.active = list.surfaces[0].id;
    const auto ids = std::pair(list.surfaces[0].id, list.surfaces[1].id);
    surfaces_.restore(list);
    ASSERT_EQ(all().size(), 2u);
    EXPECT_EQ(all()[0].name, "Skin");
    EXPECT_EQ(surfaces_.active(), &all()[0]);
    EXPECT_NE(std::pair(all()[0].id, all()[1].id), ids);
}

TEST(IsovalueForAnother, IsASuggestionApartFromTheOthersOrTheMiddleOfTheWidestGap) {
    SurfaceList list;
    list.surfaces.push_back({SurfaceId{1}, "a", 30.0, {}, 1.0, true});
    EXPECT_EQ(isovalueForAnother(list, {}, 0.0, 100.0), 65.0);
    list.surfaces.push_back({SurfaceId{2}, "b", 90.0, {}, 1.0, true});
    EXPECT_EQ(isovalueForAnother(list, {}, 0.0, 100.0), 60.0);
    const std::vector<SuggestedIsovalue> suggestions{{31.0, "too close"}, {45.0, "good"}};
    EXPECT_EQ(isovalueForAnother(list, suggestions, 0.0, 100.0), 45.0);
    EXPECT_EQ(isovalueForAnother(list, {}, 30.0, 30.0), 30.0) << "a volume of one value";
}

} // namespace
} // namespace isoslider::model
