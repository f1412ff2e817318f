#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ui/model/observers.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/model/topology/suggested_isovalue.h"

namespace isoslider::model {

/// Names a surface of a volume; no two have the same, those removed included.
enum class SurfaceId : std::uint32_t {};

/// Red, green, blue as seen.
using SurfaceColour = std::array<std::uint8_t, 3>;

struct NamedColour {
    const char* name;
    SurfaceColour colour;
};
/// What surfaces are given, the first one first. Apart by hue, and by lightness where hues are close; no orange, which
/// is that of the handle.
inline constexpr std::array<NamedColour, 8> kSurfaceColours{{{"Ivory", {230, 217, 193}},
                                                             {"Blue", {86, 150, 222}},
                                                             {"Green", {98, 186, 120}},
                                                             {"Rose", {222, 110, 150}},
                                                             {"Violet", {150, 128, 214}},
                                                             {"Yellow", {232, 208, 92}},
                                                             {"Turquoise", {84, 190, 190}},
                                                             {"Grey", {150, 156, 164}}}};

inline constexpr std::size_t kMostSurfaces = 12;
inline constexpr std::size_t kMostSurfaceNameBytes = 200;
inline constexpr double kLeastOpacity = 0.05;
/// What a surface gets that would hide another one.
inline constexpr double kSeeThroughOpacity = 0.4;

/// One surface of a volume, as the user has set it.
struct ListedSurface {
    SurfaceId id{};
    std::string name;
    double isovalue = 0.0;
    SurfaceColour colour = kSurfaceColours[0].colour;
    double opacity = 1.0; ///< kLeastOpacity to 1
    bool isVisible = true;
    HiddenPieces hiddenPieces;

    bool operator==(const ListedSurface&) const = default;
};

struct SurfaceList {
    std::vector<ListedSurface> surfaces; ///< empty without a volume
    SurfaceId active{}; ///< the one that slides, among them

    /// Null if there is none with that id.
    const ListedSurface* find(SurfaceId id) const;
    bool operator==(const SurfaceList&) const = default;
};

/// An isovalue for another surface: the best suggestion that is apart from all there are, else the middle of the widest
/// gap between those within [low, high].
double isovalueForAnother(const SurfaceList& list, std::span<const SuggestedIsovalue> suggestions, double low,
                          double high);

/// The surfaces of one volume. Window thread only. Setting what is set already notifies nobody.
///
/// Invariants, while there is a volume: 1. there are 1 to kMostSurfaces, one of them active; 2. ids differ, and none is
/// given twice; 3. names are at most kMostSurfaceNameBytes, opacities within their bounds.
class SurfacesModel {
public:
    const SurfaceList& list() const { return list_; }
    /// Null without a volume.
    const ListedSurface* active() const { return list_.find(list_.active); }

    /// A volume was opened: one surface, active.
    void begin(double isovalue);
    void clear();
    /// Of an undo, as a whole; ignored if it breaks an invariant that cannot be repaired, or without a volume.
    void setList(SurfaceList list);
    /// Of a session: as setList(), with ids of this volume.
    void restore(SurfaceList list);

    bool canAdd() const { return !list_.surfaces.empty() && list_.surfaces.size() < kMostSurfaces; }
    bool canRemove() const { return list_.surfaces.size() > 1; }
    /// A surface that becomes the active one, in a colour that no other has. Around most surfaces lie those of lower
    /// isovalues: opaque ones of the two kinds that would hide others are made see-through. Nothing unless canAdd().
    void add(double isovalue);
    /// The next one, else the one before, becomes active if it was. Nothing unless canRemove().
    void remove(SurfaceId id);
    void activate(SurfaceId id);
    /// The one `steps` further on in the list, which is a ring.
    void activateNext(int steps);
    /// Changes what is not an id. Ignored without such a surface.
    void change(SurfaceId id, const std::function<void(ListedSurface&)>& change);
    /// Of the active one.
    void setIsovalue(double isovalue);

    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }
    /// Told before a surface comes, goes, or becomes active: what was changed until then is a separate step.
    [[nodiscard]] Subscription observeRestructuring(std::function<void()> function) {
        return restructuring_.observe(std::move(function));
    }

private:
    ListedSurface* findToChange(SurfaceId id);
    ListedSurface makeSurface(double isovalue);
    void take(SurfaceList list);

    SurfaceList list_;
    std::uint32_t lastId_ = 0;
    ObserverList<> changed_, restructuring_;
};

} // namespace isoslider::model
