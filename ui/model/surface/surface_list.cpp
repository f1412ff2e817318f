#include "ui/model/surface/surface_list.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace isoslider::model {
namespace {

constexpr double kApart = 0.03; // of the range

bool hasColour(const SurfaceList& list, const SurfaceColour& colour) {
    return std::any_of(list.surfaces.begin(), list.surfaces.end(),
                       [&](const ListedSurface& surface) { return surface.colour == colour; });
}

std::string freeName(const SurfaceList& list) {
    for (std::size_t number = 1;; ++number) {
        std::string name = "Surface " + std::to_string(number);
        if (std::none_of(list.surfaces.begin(), list.surfaces.end(),
                         [&](const ListedSurface& surface) { return surface.name == name; }))
            return name;
    }
}

void repair(ListedSurface& surface) {
    if (surface.name.size() > kMostSurfaceNameBytes)
        surface.name.clear();
    surface.opacity = surface.opacity >= kLeastOpacity ? std::min(surface.opacity, 1.0) : kLeastOpacity;
}

/// What would hide another surface can be seen through from now on.
void uncover(SurfaceList& list, SurfaceId added) {
    const double isovalue = list.find(added)->isovalue;
    for (ListedSurface& surface : list.surfaces) {
        const bool hides = surface.id == added
                               ? std::any_of(list.surfaces.begin(), list.surfaces.end(),
                                             [&](const ListedSurface& other) { return other.isovalue > isovalue; })
                               : surface.isovalue < isovalue;
        if (hides && surface.opacity >= 1.0)
            surface.opacity = kSeeThroughOpacity;
    }
}

} // namespace

const ListedSurface* SurfaceList::find(SurfaceId id) const {
    const auto found =
        std::find_if(surfaces.begin(), surfaces.end(), [id](const ListedSurface& surface) { return surface.id == id; });
    return found != surfaces.end() ? &*found : nullptr;
}

double isovalueForAnother(const SurfaceList& list, std::span<const SuggestedIsovalue> suggestions, double low,
                          double high) {
    const double apart = kApart * (high / 2.0 - low / 2.0) * 2.0;
    for (const SuggestedIsovalue& suggestion : suggestions)
        if (std::none_of(list.surfaces.begin(), list.surfaces.end(), [&](const ListedSurface& surface) {
                return std::abs(surface.isovalue - suggestion.isovalue) < apart;
            }))
            return suggestion.isovalue;
    std::vector<double> ends{low, high};
    for (const ListedSurface& surface : list.surfaces)
        ends.push_back(std::clamp(surface.isovalue, low, high));
    std::sort(ends.begin(), ends.end());
    double best = low, widest = -1.0;
    for (std::size_t i = 1; i < ends.size(); ++i)
        if (const double gap = ends[i] - ends[i - 1]; gap > widest) {
            widest = gap;
            best = std::midpoint(ends[i - 1], ends[i]);
        }
    return best;
}

ListedSurface* SurfacesModel::findToChange(SurfaceId id) { return const_cast<ListedSurface*>(list_.find(id)); }

ListedSurface SurfacesModel::makeSurface(double isovalue) {
    ListedSurface surface;
    surface.id = SurfaceId{++lastId_};
    surface.name = freeName(list_);
    surface.isovalue = isovalue;
    const auto unused = std::find_if(kSurfaceColours.begin(), kSurfaceColours.end(),
                                     [&](const NamedColour& named) { return !hasColour(list_, named.colour); });
    const std::size_t any = list_.surfaces.size() % kSurfaceColours.size();
    surface.colour = unused != kSurfaceColours.end() ? unused->colour : kSurfaceColours[any].colour;
    return surface;
}

void SurfacesModel::take(SurfaceList list) {
    if (list == list_)
        return;
    const bool isSame =
        list.active == list_.active &&
        std::equal(list.surfaces.begin(), list.surfaces.end(), list_.surfaces.begin(), list_.surfaces.end(),
                   [](const ListedSurface& a, const ListedSurface& b) { return a.id == b.id; });
    if (!isSame)
        restructuring_.notify();
    list_ = std::move(list);
    changed_.notify();
}

void SurfacesModel::begin(double isovalue) {
    lastId_ = 0;
    list_ = {};
    SurfaceList list;
    list.surfaces.push_back(makeSurface(isovalue));
    list.active = list.surfaces.front().id;
    take(std::move(list));
}

void SurfacesModel::clear() { take({}); }

void SurfacesModel::setList(SurfaceList list) {
    if (list_.surfaces.empty() || list.surfaces.empty() || list.surfaces.size() > kMostSurfaces ||
        list.find(list.active) == nullptr)
        return;
    for (std::size_t i = 0; i < list.surfaces.size(); ++i) {
        repair(list.surfaces[i]);
        if (list.find(list.surfaces[i].id) != &list.surfaces[i])
            return; // two with one id
        lastId_ = std::max(lastId_, static_cast<std::uint32_t>(list.surfaces[i].id));
    }
    take(std::move(list));
}

void SurfacesModel::restore(SurfaceList list) {
    const ListedSurface* active = list.find(list.active);
    const auto place = active != nullptr ? static_cast<std::size_t>(active - list.surfaces.data()) : 0;
    for (ListedSurface& surface : list.surfaces)
        surface.id = SurfaceId{++lastId_};
    if (place < list.surfaces.size())
        list.active = list.surfaces[place].id;
    setList(std::move(list));
}

void SurfacesModel::add(double isovalue) {
    if (!canAdd())
        return;
    SurfaceList list = list_;
    list.surfaces.push_back(makeSurface(isovalue));
    list.active = list.surfaces.back().id;
    uncover(list, list.active);
    take(std::move(list));
}

void SurfacesModel::remove(SurfaceId id) {
    const ListedSurface* surface = list_.find(id);
    if (!canRemove() || surface == nullptr)
        return;
    const auto place = surface - list_.surfaces.data();
    SurfaceList list = list_;
    list.surfaces.erase(list.surfaces.begin() + place);
    if (list.active == id)
        list.active = list.surfaces[std::min(static_cast<std::size_t>(place), list.surfaces.size() - 1)].id;
    take(std::move(list));
}

void SurfacesModel::activate(SurfaceId id) {
    if (list_.find(id) == nullptr)
        return;
    SurfaceList list = list_;
    list.active = id;
    take(std::move(list));
}

void SurfacesModel::activateNext(int steps) {
    const ListedSurface* surface = active();
    if (surface == nullptr)
        return;
    const auto count = static_cast<std::ptrdiff_t>(list_.surfaces.size());
    const std::ptrdiff_t place = surface - list_.surfaces.data() + steps % count + count;
    activate(list_.surfaces[static_cast<std::size_t>(place % count)].id);
}

void SurfacesModel::change(SurfaceId id, const std::function<void(ListedSurface&)>& change) {
    const ListedSurface* surface = list_.find(id);
    if (surface == nullptr)
        return;
    ListedSurface changed = *surface;
    change(changed);
    changed.id = id;
    repair(changed);
    if (changed == *surface)
        return;
    *findToChange(id) = std::move(changed);
    changed_.notify();
}

void SurfacesModel::setIsovalue(double isovalue) {
    change(list_.active, [isovalue](ListedSurface& surface) { surface.isovalue = isovalue; });
}

} // namespace isoslider::model
