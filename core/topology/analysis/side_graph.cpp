#include "core/topology/analysis/side_graph.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/grid/scalar_type.h"

namespace isoslider::topology {

// Grid points between two strips belong to both: what they lead to in each is one from their scalars on. Those of a
// strip's last row are the next one's first row, which is linked with all that is around it.
template <class Sample>
Status SideGraph::add(const StripComponents& part, const LayerWindow<Sample>& window, const Strip& strip) {
    const std::size_t base = graph_.seeds.size();
    if (base + part.graph.seeds.size() >= kNoSeed)
        return makeError(ErrorCode::OutOfSpace, "the volume has too many extremes for its topology to be analysed");
    graph_.seeds.insert(graph_.seeds.end(), part.graph.seeds.begin(), part.graph.seeds.end());
    opens_.insert(opens_.end(), part.opens.begin(), part.opens.end());
    const auto first = static_cast<std::uint32_t>(base);
    for (Link link : part.graph.links) {
        link.a += first;
        link.b += first;
        graph_.links.push_back(link);
    }
    const auto row = static_cast<std::size_t>(window.rowStep()), plane = static_cast<std::size_t>(window.planeStep());
    const std::size_t begin = row * static_cast<std::size_t>(strip.yBegin),
                      owned = row * static_cast<std::size_t>(window.ownedEnd(strip) - strip.yBegin);
    const auto link = [&](std::size_t place, std::uint32_t there, std::uint32_t here) {
        if (there != kNoSeed && here != kNoSeed)
            between_.add(static_cast<double>(window.layer()[place]), Cause::vertex(window.firstPoint() + place), there,
                         here + first);
    };
    if (!top_.empty())
        for (std::size_t i = 0; i < owned; ++i)
            link(begin + i, top_[begin + i], part.bottom[i]);
    if (strip.yBegin > 0)
        for (std::size_t i = 0; i < part.front.size(); ++i)
            link(begin + i / row * plane + i % row, back_[i], part.front[i]);
    const auto inGraph = [first](std::uint32_t seed) { return seed != kNoSeed ? seed + first : kNoSeed; };
    nextTop_.resize(plane);
    std::transform(part.top.begin(), part.top.begin() + static_cast<std::ptrdiff_t>(owned),
                   nextTop_.begin() + static_cast<std::ptrdiff_t>(begin), inGraph);
    back_.resize(part.back.size());
    std::transform(part.back.begin(), part.back.end(), back_.begin(), inGraph);
    ISO_TRY(sums_.add(part.settled));
    return window.isLast(strip) ? settle() : Status();
}

// What no longer touches anything that is to come is settled.
Status SideGraph::settle() {
    std::vector<Link> links = between_.take();
    graph_.links.insert(graph_.links.end(), links.begin(), links.end());
    between_.giveMemory(links);
    ComponentHistory settled;
    const std::vector<std::uint32_t> parts = settleComponents(graph_, opens_, settled, between_.order());
    top_.swap(nextTop_);
    for (std::uint32_t& seed : top_)
        seed = seed != kNoSeed ? parts[seed] : kNoSeed;
    // Only points of the next layer's top will be open.
    opens_.assign(graph_.seeds.size(), std::numeric_limits<double>::quiet_NaN());
    return sums_.add(settled);
}

Result<SideChanges> SideGraph::take(double span) {
    ComponentHistory history;
    finishComponents(std::move(graph_), span, history);
    ISO_TRY(sums_.add(history));
    return sums_.take();
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Status SideGraph::add(const StripComponents&, const LayerWindow<Sample>&, const Strip&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
