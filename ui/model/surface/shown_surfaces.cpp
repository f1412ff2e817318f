#include "ui/model/surface/shown_surfaces.h"

#include <utility>

#include <glm/geometric.hpp>

#include "ui/model/pieces/shown_hit.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {

std::vector<ShownSurface> shownSurfaces(const Session& session, const ViewOptions& view) {
    std::vector<ShownSurface> shown;
    const SurfaceList& first = session.surfaces().list();
    const auto add = [&shown](const ListedSurface& surface, std::shared_ptr<const extract::SurfaceFrame> frame,
                              PieceOptions pieces, bool isOfSecond) {
        if (frame && surface.isVisible)
            shown.push_back({surface.id, isOfSecond, surface.opacity < 0.5, std::move(frame), std::move(pieces)});
    };
    if (const ListedSurface* active = first.find(first.active))
        add(*active, session.pictureOf(active->id), view.pieces, false);
    for (const ListedSurface& surface : first.surfaces)
        if (surface.id != first.active)
            add(surface, session.pictureOf(surface.id), PieceOptions(surface.hiddenPieces), false);
    for (const ListedSurface& surface : session.secondVolume().surfaces().list().surfaces)
        add(surface, session.secondVolume().pictureOf(surface.id), PieceOptions(surface.hiddenPieces), true);
    return shown;
}

std::optional<ShownPlace> firstShownPlace(std::span<const ShownSurface> surfaces, const Clipping& clipping,
                                          const GridGeometry& volume, const glm::dvec3& from, const glm::dvec3& to) {
    std::optional<ShownPlace> nearest;
    const glm::dvec3 sight = to - from;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const extract::SurfaceFrame& frame = *surfaces[i].frame;
        const auto cuts = cutsOf(clipping, frame.geometry, volume);
        const auto hit = firstShownHit(frame, surfaces[i].pieces, cuts, indexOfCentred(from, frame.geometry, volume),
                                       indexOfCentred(to, frame.geometry, volume));
        if (!hit)
            continue;
        const glm::dvec3 place = centredWorldOf(hit->place, frame.geometry, volume);
        const bool isBefore = nearest && glm::dot(place - nearest->place, sight) < 0.0;
        const bool wasSeeThrough = nearest && surfaces[nearest->surface].isSeeThrough;
        if (!nearest || (surfaces[i].isSeeThrough == wasSeeThrough ? isBefore : wasSeeThrough))
            nearest = ShownPlace{i, *hit, place};
    }
    return nearest;
}

} // namespace isoslider::model
