#include "core/topology/analysis/strip_components.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "core/grid/scalar_type.h"

namespace isoslider::topology {
namespace {

constexpr Neighbours kEdgesOnly = (1u << kEdgeNeighbours) - 1;

/// What follows from which of a point's neighbours are there and come earlier.
struct NeighbourTables {
    std::array<Neighbours, 256> existing{}; ///< by star
    std::array<Neighbours, kEdgeNeighbours> beyond{}; ///< those in the next row or plane that way
    std::array<std::uint8_t, 64> first{}; ///< by those along edges: the one that the point leads to; 6: none
    /// Those along edges are joined before the point where the corner between two of them, across a face, comes
    /// earlier too. Bits of one of each component that is left, but for that of `first`.
    std::vector<std::uint8_t> apart;
};

std::uint8_t apartOf(Neighbours earlier, unsigned first) {
    std::array<std::uint8_t, kEdgeNeighbours> joined{}; // by neighbour
    for (unsigned n = 0; n < kEdgeNeighbours; ++n)
        joined[n] = static_cast<std::uint8_t>(earlier & 1u << n);
    for (std::size_t f = 0; f < kFacePairs.size(); ++f) {
        const auto [a, b] = kFacePairs[f];
        if ((earlier >> (kEdgeNeighbours + f) & 1u) == 0 || joined[a] == 0 || joined[b] == 0)
            continue;
        const auto both = static_cast<std::uint8_t>(joined[a] | joined[b]);
        for (unsigned n = 0; n < kEdgeNeighbours; ++n)
            if ((both >> n & 1u) != 0)
                joined[n] = both;
    }
    unsigned apart = 0, seen = first < kEdgeNeighbours ? joined[first] : 0u;
    for (unsigned n = 0; n < kEdgeNeighbours; ++n)
        if (joined[n] != 0 && (seen >> n & 1u) == 0) {
            apart |= 1u << n;
            seen |= joined[n];
        }
    return static_cast<std::uint8_t>(apart);
}

const NeighbourTables& neighbourTables() {
    static const NeighbourTables tables = [] {
        NeighbourTables made;
        for (std::size_t star = 0; star < 256; ++star) {
            for (unsigned n = 0; n < kEdgeNeighbours; ++n)
                made.existing[star] |= (star & kStarSides[n]) != 0 ? 1u << n : 0u;
            for (std::size_t f = 0; f < kFacePairs.size(); ++f)
                if ((star & kStarSides[kFacePairs[f][0]] & kStarSides[kFacePairs[f][1]]) != 0)
                    made.existing[star] |= 1u << (kEdgeNeighbours + f);
        }
        const auto with = [](unsigned neighbour) {
            Neighbours all = 1u << neighbour;
            for (std::size_t f = 0; f < kFacePairs.size(); ++f)
                if (kFacePairs[f][0] == neighbour || kFacePairs[f][1] == neighbour)
                    all |= 1u << (kEdgeNeighbours + f);
            return all;
        };
        for (unsigned n = 0; n < kEdgeNeighbours; ++n)
            made.beyond[n] = with(n);
        for (unsigned edges = 0; edges < made.first.size(); ++edges) {
            unsigned way = kEdgeNeighbours;
            for (const unsigned n : {5u, 3u, 1u, 4u, 2u, 0u})
                way = (edges >> n & 1u) != 0 ? n : way;
            made.first[edges] = static_cast<std::uint8_t>(way);
        }
        // Corners matter only between two neighbours that come earlier: those that do not are left out first.
        made.apart.resize(kAllNeighbours + 1);
        for (Neighbours earlier = 0; earlier <= kAllNeighbours; ++earlier) {
            Neighbours matter = earlier & kEdgesOnly;
            for (std::size_t f = 0; f < kFacePairs.size(); ++f)
                if ((matter >> kFacePairs[f][0] & matter >> kFacePairs[f][1] & 1u) != 0)
                    matter |= earlier & 1u << (kEdgeNeighbours + f);
            made.apart[earlier] =
                matter < earlier ? made.apart[matter] : apartOf(earlier, made.first[earlier & kEdgesOnly]);
        }
        return made;
    }();
    return tables;
}

template <class Sample, Side kSide>
class StripFlood {
public:
    StripFlood(const LayerWindow<Sample>& window, const Strip& strip, std::vector<std::uint32_t>& leadsTo,
               std::vector<Seed>& seeds, LinkCollector& links, std::vector<PointMeeting>& meetings)
        : window_(window),
          strip_(strip),
          samples_(window.layer()),
          row_(window.rowStep()),
          plane_(window.points(strip)),
          planes_(window.zEnd - window.zBegin + 1),
          leadsTo_(leadsTo),
          seeds_(seeds),
          links_(links),
          meetings_(meetings) {
        leadsTo_.resize(static_cast<std::size_t>(plane_ * planes_));
    }

    void run() {
        findNeighbours();
        numberSeeds();
        links_.setSeeds(seeds_.size());
        if (!window_.stop.stop_requested())
            linkNeighbours();
    }

private:
    std::uint32_t leadsTo(std::int64_t at) const { return leadsTo_[static_cast<std::size_t>(at)]; }
    // A place in the strip's plane is one in the layer with this added.
    std::int64_t shift(std::int64_t plane) const { return window_.shift(strip_, window_.zBegin + plane); }

    // The first neighbour found that comes earlier, or the point itself; those before it first: where they lead to is
    // known then, as far as it was. Of equal scalars that come earlier to the side above has the greater place.
    void findNeighbours() {
        const NeighbourTables& tables = neighbourTables();
        const std::array<std::int64_t, 7> steps{-1, 1, -row_, row_, -plane_, plane_, 0};
        std::size_t count = 0;
        for (std::int64_t first = 0; first < plane_ * planes_; first += row_) {
            if (meetings_.size() < count + static_cast<std::size_t>(row_))
                meetings_.resize(2 * count + static_cast<std::size_t>(row_));
            const std::int64_t plane = first / plane_, inPlane = first % plane_, rowShift = shift(plane);
            const auto inside = [&](bool isOutermost, unsigned way) {
                return isOutermost ? ~tables.beyond[way] : kAllNeighbours;
            };
            const Neighbours inStrip = inside(inPlane == 0, 2) & inside(inPlane + row_ == plane_, 3) &
                                       inside(plane == 0, 4) & inside(plane + 1 == planes_, 5);
            const auto find = [&](std::int64_t at) {
                const Neighbours higher = window_.higher.at(window_.inPlanes(at + rowShift));
                const Neighbours earlier = (kSide == Side::Above ? higher : ~higher) & inStrip &
                                           tables.existing[window_.stars[static_cast<std::size_t>(at + rowShift)]];
                const unsigned way = tables.first[earlier & kEdgesOnly];
                const std::int64_t to = at + steps[way];
                leadsTo_[static_cast<std::size_t>(at)] = to < at ? leadsTo(to) : static_cast<std::uint32_t>(to);
                meetings_[count] = {static_cast<std::uint32_t>(at), tables.apart[earlier]};
                count += tables.apart[earlier] != 0 ? 1 : 0;
            };
            if (window_.isFlat(strip_.yBegin + inPlane / row_, window_.zBegin + plane)) {
                // Equal points lead along the row, to one end of it.
                const std::int64_t end = kSide == Side::Above ? first + row_ - 1 : first;
                find(end);
                std::fill_n(leadsTo_.begin() + static_cast<std::ptrdiff_t>(first), row_, leadsTo(end));
                continue;
            }
            for (std::int64_t at = first; at < first + row_; ++at)
                find(at);
        }
        meetings_.resize(count);
    }

    std::uint32_t rootOf(std::uint32_t at) {
        while (leadsTo_[at] != at) {
            leadsTo_[at] = leadsTo_[leadsTo_[at]];
            at = leadsTo_[at];
        }
        return at;
    }

    // function(place in the strip, place in the layer)
    template <class Function>
    void forEachPoint(const Function& function) const {
        for (std::int64_t plane = 0; plane < planes_; ++plane) {
            const std::int64_t planeShift = shift(plane);
            for (std::int64_t at = plane_ * plane; at < plane_ * (plane + 1); ++at)
                function(static_cast<std::uint32_t>(at), static_cast<std::size_t>(at + planeShift));
        }
    }

    void numberSeeds() {
        const auto count = static_cast<std::uint32_t>(leadsTo_.size());
        for (std::uint32_t at = 0; at < count; ++at)
            leadsTo_[at] = rootOf(at);
        // Seeds first, by their own places; then numbers stand there, which have a bit that places have not.
        constexpr std::uint32_t kIsNumber = std::uint32_t{1} << 31;
        seeds_.clear();
        forEachPoint([&](std::uint32_t at, std::size_t place) {
            if (window_.stars[place] == 0) {
                leadsTo_[at] = kNoSeed;
            } else if (leadsTo_[at] == at) {
                leadsTo_[at] = static_cast<std::uint32_t>(seeds_.size()) | kIsNumber;
                seeds_.push_back({static_cast<double>(samples_[place]), std::numeric_limits<double>::quiet_NaN(),
                                  window_.firstPoint() + place});
            }
        });
        forEachPoint([&](std::uint32_t at, std::size_t place) {
            const std::uint32_t to = leadsTo_[at];
            if (to == kNoSeed)
                return;
            const std::uint32_t seed = ((to & kIsNumber) != 0 ? to : leadsTo_[to]) & ~kIsNumber;
            leadsTo_[at] = seed;
            if (kSide == Side::Below && window_.stars[place] != kWholeStar)
                reachBoundary(seeds_[seed], static_cast<double>(samples_[place]));
        });
    }
    static void reachBoundary(Seed& seed, double isovalue) {
        if (!(seed.reachesBoundary <= isovalue)) // or not a number
            seed.reachesBoundary = isovalue;
    }

    // Where a point's neighbours have not come together before it they do so here.
    void linkNeighbours() {
        const std::array<std::int64_t, 6> steps{-1, 1, -row_, row_, -plane_, plane_};
        auto meeting = meetings_.begin();
        for (std::int64_t plane = 0; plane < planes_; ++plane) {
            const std::int64_t planeShift = shift(plane);
            for (; meeting != meetings_.end() && meeting->at < plane_ * (plane + 1); ++meeting) {
                const auto place = static_cast<std::size_t>(meeting->at + planeShift);
                const std::uint32_t seed = leadsTo_[meeting->at];
                for (unsigned apart = meeting->apart; apart != 0; apart &= apart - 1) {
                    const auto way = static_cast<std::size_t>(std::countr_zero(apart));
                    links_.add(static_cast<double>(samples_[place]), Cause::vertex(window_.firstPoint() + place), seed,
                               leadsTo(meeting->at + steps[way]));
                }
            }
        }
    }

    const LayerWindow<Sample>& window_;
    const Strip strip_;
    const Sample* samples_;
    std::int64_t row_, plane_; ///< steps within the strip
    std::int64_t planes_;
    std::vector<std::uint32_t>& leadsTo_; ///< a point; in the end a seed
    std::vector<Seed>& seeds_;
    LinkCollector& links_;
    std::vector<PointMeeting>& meetings_;
};

} // namespace

template <class Sample>
void StripSide::flood(const LayerWindow<Sample>& window, const Strip& strip) {
    row_ = static_cast<std::size_t>(window.rowStep());
    plane_ = static_cast<std::size_t>(window.points(strip));
    if (side_ == Side::Above)
        StripFlood<Sample, Side::Above>(window, strip, leadsTo_, seeds_, links_, meetings_).run();
    else
        StripFlood<Sample, Side::Below>(window, strip, leadsTo_, seeds_, links_, meetings_).run();
}

StripComponents StripSide::sidesOf() const {
    StripComponents found;
    const auto copy = [this](std::size_t from, std::size_t count, std::vector<std::uint32_t>& to) {
        const auto begin = leadsTo_.begin() + static_cast<std::ptrdiff_t>(from);
        to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    copy(0, plane_, found.bottom);
    copy(leadsTo_.size() - plane_, plane_, found.top);
    for (std::size_t plane = 0; plane < leadsTo_.size(); plane += plane_) {
        copy(plane, row_, found.front);
        copy(plane + plane_ - row_, row_, found.back);
    }
    return found;
}

StripComponents StripSide::takeForest() {
    StripComponents found = sidesOf();
    graph_.links = links_.take();
    keepForest(side_, seeds_.size(), graph_.links, links_.order());
    found.graph = {side_, seeds_, graph_.links};
    links_.giveMemory(graph_.links);
    return found;
}

template <class Sample>
StripComponents StripSide::takeSettled(const LayerWindow<Sample>& window, const Strip& strip) {
    StripComponents found = sidesOf();
    graph_.side = side_;
    graph_.seeds.swap(seeds_);
    graph_.links = links_.take();
    const auto open = [this](std::span<const std::uint32_t> row, const Sample* samples, std::vector<double>& opens) {
        for (std::size_t i = 0; i < row.size(); ++i)
            if (row[i] != kNoSeed)
                opens[row[i]] = earlier(side_, opens[row[i]], static_cast<double>(samples[i]));
    };
    const auto rowAt = [&](std::int64_t y, std::int64_t z) {
        return window.layer() + window.rowStep() * y + window.planeStep() * (z - window.zBegin);
    };
    const auto openRows = [&](const std::vector<std::uint32_t>& rows, std::int64_t y, std::vector<double>& opens) {
        for (std::int64_t z = window.zBegin; z <= window.zEnd; ++z)
            open(std::span(rows).subspan(row_ * static_cast<std::size_t>(z - window.zBegin), row_), rowAt(y, z), opens);
    };
    constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> opens(graph_.seeds.size(), kNever);
    if (window.zBegin > 0)
        open(found.bottom, rowAt(strip.yBegin, window.zBegin), opens);
    if (!window.isLast())
        open(found.top, rowAt(strip.yBegin, window.zEnd), opens);
    if (strip.yBegin > 0)
        openRows(found.front, strip.yBegin, opens);
    if (!window.isLast(strip))
        openRows(found.back, strip.yEnd, opens);
    const std::vector<std::uint32_t> parts = settleComponents(graph_, opens, found.settled, links_.order());
    for (auto* outer : {&found.bottom, &found.top, &found.front, &found.back})
        for (std::uint32_t& seed : *outer)
            seed = seed != kNoSeed ? parts[seed] : kNoSeed;
    found.graph = {side_, graph_.seeds, graph_.links};
    links_.giveMemory(graph_.links);
    seeds_.swap(graph_.seeds);
    found.opens.assign(found.graph.seeds.size(), kNever);
    if (!window.isLast())
        open(found.top, rowAt(strip.yBegin, window.zEnd), found.opens);
    return found;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void StripSide::flood(const LayerWindow<Sample>&, const Strip&); \
    template StripComponents StripSide::takeSettled(const LayerWindow<Sample>&, const Strip&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
