#include "core/topology/analysis/layer_components.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/grid/scalar_type.h"

namespace isoslider::topology {
namespace {

template <class Sample, Side kSide>
class LayerFlood {
public:
    LayerFlood(const LayerWindow<Sample>& window, std::vector<std::uint32_t>& leadsTo, std::vector<Seed>& seeds,
               LinkCollector& links)
        : window_(window),
          samples_(window.layer()),
          row_(window.rowStep()),
          plane_(window.planeStep()),
          leadsTo_(leadsTo),
          seeds_(seeds),
          links_(links) {
        leadsTo_.resize(static_cast<std::size_t>(window.points()));
    }

    void run() {
        findNeighbours();
        numberSeeds();
        links_.setSeeds(seeds_.size());
        if (!window_.stop.stop_requested())
            linkNeighbours();
    }

private:
    static bool isEarlier(Sample a, Sample b) { return kSide == Side::Above ? a > b : a < b; }
    std::uint32_t leadsTo(std::int64_t at) const { return leadsTo_[static_cast<std::size_t>(at)]; }

    // The first neighbour found that comes earlier, or the point itself; those before it first: where they lead to is
    // known then. Of equal scalars the one with the lesser place counts as earlier.
    void findNeighbours() {
        const CellStar* const stars = window_.stars.data();
        const auto top = window_.points() - plane_;
        const std::int64_t count = window_.points();
        for (std::int64_t at = 0; at < count; ++at) {
            const CellStar star = stars[at];
            const Sample own = samples_[at];
            auto& to = leadsTo_[static_cast<std::size_t>(at)];
            const auto isBefore = [&](std::size_t way, std::int64_t other) {
                return (star & kStarSides[way]) != 0 && !isEarlier(own, samples_[other]);
            };
            const auto isAfter = [&](std::size_t way, std::int64_t other) {
                return (star & kStarSides[way]) != 0 && isEarlier(samples_[other], own);
            };
            if (isBefore(0, at - 1))
                to = root(at - 1);
            else if (isBefore(2, at - row_))
                to = root(at - row_);
            else if (at >= plane_ && isBefore(4, at - plane_))
                to = root(at - plane_);
            else if (isAfter(1, at + 1))
                to = static_cast<std::uint32_t>(at + 1);
            else if (isAfter(3, at + row_))
                to = static_cast<std::uint32_t>(at + row_);
            else if (at < top && isAfter(5, at + plane_))
                to = static_cast<std::uint32_t>(at + plane_);
            else
                to = static_cast<std::uint32_t>(at);
        }
    }
    // Of a point before the present one: where it leads to as far as is known.
    std::uint32_t root(std::int64_t before) const { return leadsTo_[static_cast<std::size_t>(before)]; }

    std::uint32_t rootOf(std::uint32_t at) {
        while (leadsTo_[at] != at) {
            leadsTo_[at] = leadsTo_[leadsTo_[at]];
            at = leadsTo_[at];
        }
        return at;
    }

    void numberSeeds() {
        const auto count = static_cast<std::uint32_t>(leadsTo_.size());
        for (std::uint32_t at = 0; at < count; ++at)
            leadsTo_[at] = rootOf(at);
        // Seeds first, by their own places; they then stand for numbers.
        std::vector<std::uint32_t> numbers(count);
        for (std::uint32_t at = 0; at < count; ++at)
            if (leadsTo_[at] == at && window_.stars[at] != 0) {
                numbers[at] = static_cast<std::uint32_t>(seeds_.size());
                seeds_.push_back({static_cast<double>(samples_[at]), std::numeric_limits<double>::quiet_NaN(),
                                  window_.firstPoint() + at});
            }
        for (std::uint32_t at = 0; at < count; ++at) {
            leadsTo_[at] = window_.stars[at] != 0 ? numbers[leadsTo_[at]] : kNoSeed;
            if (kSide == Side::Below && window_.stars[at] != 0 && window_.stars[at] != kWholeStar)
                reachBoundary(seeds_[leadsTo_[at]], static_cast<double>(samples_[at]));
        }
    }
    static void reachBoundary(Seed& seed, double isovalue) {
        if (!(seed.reachesBoundary <= isovalue)) // or not a number
            seed.reachesBoundary = isovalue;
    }

    void linkNeighbours() {
        const std::array<std::int64_t, 3> steps{1, row_, plane_};
        const std::int64_t count = window_.points(), top = count - plane_;
        for (std::int64_t at = 0; at < count; ++at) {
            const std::uint32_t seed = leadsTo(at);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if ((window_.stars[static_cast<std::size_t>(at)] & kStarSides[2 * axis + 1]) == 0 ||
                    (axis == 2 && at >= top))
                    continue;
                const std::int64_t next = at + steps[axis];
                if (leadsTo(next) == seed)
                    continue;
                const std::int64_t later = isEarlier(samples_[at], samples_[next]) ? next : at;
                links_.add(static_cast<double>(samples_[later]),
                           Cause::vertex(window_.firstPoint() + static_cast<Point>(later)), seed, leadsTo(next));
            }
        }
    }

    const LayerWindow<Sample>& window_;
    const Sample* samples_;
    std::int64_t row_, plane_;
    std::vector<std::uint32_t>& leadsTo_; ///< a point; in the end a seed
    std::vector<Seed>& seeds_;
    LinkCollector& links_;
};

} // namespace

template <class Sample>
void LayerSide::flood(const LayerWindow<Sample>& window) {
    if (side_ == Side::Above)
        LayerFlood<Sample, Side::Above>(window, leadsTo_, seeds_, links_).run();
    else
        LayerFlood<Sample, Side::Below>(window, leadsTo_, seeds_, links_).run();
}

LayerComponents LayerSide::take(std::int64_t planePoints) {
    LayerComponents found;
    found.links = links_.take();
    keepForest(side_, seeds_.size(), found.links);
    found.links.shrink_to_fit(); // a layer may wait for others
    found.seeds = std::move(seeds_);
    const auto plane = static_cast<std::ptrdiff_t>(planePoints);
    found.bottom.assign(leadsTo_.begin(), leadsTo_.begin() + plane);
    found.top.assign(leadsTo_.end() - plane, leadsTo_.end());
    return found;
}

#define ISO_INSTANTIATE(Sample, Name) template void LayerSide::flood(const LayerWindow<Sample>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
