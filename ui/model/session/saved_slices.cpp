#include "ui/model/session/saved_slices.h"

#include <array>
#include <limits>

#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace {

constexpr std::array<const char*, 4> kSliceNames{"x", "y", "z", "oblique"}; // by SliceKind
constexpr std::array<const char*, 4> kLayoutNames{"none", "one", "three", "four"}; // by SliceLayout

} // namespace

Json slicesJson(const SliceOptions& slices) {
    const auto& q = slices.orientation;
    Json json{{"layout", kLayoutNames[static_cast<std::size_t>(slices.layout)]},
              {"pane", kSliceNames[placeOf(slices.onePane)]},
              {"position", arrayOf(slices.position, 3)},
              {"orientation", {q.w, q.x, q.y, q.z}},
              {"contour", slices.showsContour},
              {"crosshair", slices.showsCrosshair}};
    Json& inScene = json["inScene"] = Json::object();
    Json& views = json["views"] = Json::object();
    for (const SliceKind kind : kSliceKinds) {
        const PaneView& view = slices.views[placeOf(kind)];
        inScene[kSliceNames[placeOf(kind)]] = slices.inScene[placeOf(kind)];
        views[kSliceNames[placeOf(kind)]] = {view.zoom, view.middle.x, view.middle.y};
    }
    if (slices.window)
        json["window"] = {slices.window->low, slices.window->high};
    return json;
}

SliceOptions slicesFromJson(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "slices", problems);
    SliceOptions slices;
    choose(members, "layout", kLayoutNames, slices.layout);
    choose(members, "pane", kSliceNames, slices.onePane);
    if (!members.numbers("position", slices.position, 3))
        slices.position = glm::dvec3(std::numeric_limits<double>::quiet_NaN()); // none: the middle
    std::array<double, 4> turn{1.0, 0.0, 0.0, 0.0};
    members.numbers("orientation", turn, 4);
    slices.orientation = glm::dquat(turn[0], turn[1], turn[2], turn[3]);
    std::array<double, 2> window{};
    if (members.numbers("window", window, 2)) {
        if (window[0] < window[1])
            slices.window = ValueWindow{window[0], window[1]};
        else
            members.reportOf("window", "does not ascend and is ignored");
    }
    members.flag("contour", slices.showsContour);
    members.flag("crosshair", slices.showsCrosshair);
    if (const Json* inScene = members.find("inScene")) {
        Members kinds(*inScene, "slices, inScene", problems);
        for (const SliceKind kind : kSliceKinds)
            kinds.flag(kSliceNames[placeOf(kind)], slices.inScene[placeOf(kind)]);
    }
    if (const Json* views = members.find("views")) {
        Members kinds(*views, "slices, views", problems);
        for (const SliceKind kind : kSliceKinds) {
            std::array<double, 3> view{};
            if (kinds.numbers(kSliceNames[placeOf(kind)], view, 3))
                slices.views[placeOf(kind)] = {view[0], {view[1], view[2]}};
        }
    }
    return slices;
}

} // namespace isoslider::model
