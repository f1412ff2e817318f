#include "ui/model/topology/event_words.h"

#include <array>
#include <vector>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

using topology::SurfaceCounts;
using topology::TopologyEvent;

// Counts of a damaged file may be anything; their difference must not overflow.
int signOfChange(std::int64_t below, std::int64_t above) { return above > below ? 1 : above < below ? -1 : 0; }

std::uint64_t sizeOfChange(std::int64_t below, std::int64_t above) {
    const auto a = static_cast<std::uint64_t>(above), b = static_cast<std::uint64_t>(below);
    return above > below ? a - b : b - a;
}

bool listsPieces(const TopologyEvent& event) { return !(event.pieces == topology::PieceChanges{}); }

int changeOfPieces(const TopologyEvent& event) {
    return listsPieces(event) ? 0 : signOfChange(event.below.components, event.above.components);
}

/// "a piece splits", "3 pieces split".
std::string counted(std::uint64_t count, const char* one, const char* many) {
    return count == 1 ? one : groupedText(count) + " " + many;
}

std::string named(std::int64_t count, const char* one, const char* many) {
    return groupedText(count) + " " + (count == 1 ? one : many);
}

std::vector<std::string> changesOfPieces(const TopologyEvent& event) {
    std::vector<std::string> changes;
    const auto add = [&changes](std::uint64_t count, const char* one, const char* many) {
        if (count > 0)
            changes.push_back(counted(count, one, many));
    };
    const auto& pieces = event.pieces;
    add(pieces.births, "a piece appears", "pieces appear");
    add(pieces.deaths, "a piece disappears", "pieces disappear");
    if (pieces.joins > 0)
        changes.push_back(pieces.joins == 1 ? "two pieces join"
                                            : "pieces join " + groupedText(std::uint64_t{pieces.joins}) + " times");
    if (pieces.splits > 0)
        changes.push_back(pieces.splits == 1 ? "a piece splits"
                                             : "pieces split " + groupedText(std::uint64_t{pieces.splits}) + " times");
    return changes;
}

std::string changeOfOthers(const TopologyEvent& event) {
    const auto words = [](std::int64_t below, std::int64_t above, const std::array<const char*, 4>& of) {
        const bool isMore = above > below;
        return counted(sizeOfChange(below, above), isMore ? of[0] : of[2], isMore ? of[1] : of[3]);
    };
    const SurfaceCounts &below = event.below, &above = event.above;
    if (below.handles() != above.handles())
        return words(below.handles(), above.handles(),
                     {"a tunnel opens", "tunnels open", "a tunnel closes", "tunnels close"});
    if (below.voids != above.voids)
        return words(below.voids, above.voids,
                     {"a void appears", "voids appear", "a void disappears", "voids disappear"});
    if (below.loops != above.loops)
        return words(below.loops, above.loops,
                     {"a boundary loop appears", "boundary loops appear", "a boundary loop disappears",
                      "boundary loops disappear"});
    return "no count changes";
}

} // namespace

EventClass classOf(const TopologyEvent& event) {
    const auto& pieces = event.pieces;
    if (!listsPieces(event)) {
        const int change = changeOfPieces(event);
        return change > 0 ? EventClass::PieceComes : change < 0 ? EventClass::PieceGoes : EventClass::Other;
    }
    EventClass kind = EventClass::PiecesJoin;
    std::uint32_t most = pieces.joins;
    const auto consider = [&](std::uint32_t count, EventClass of) {
        if (count > most) {
            most = count;
            kind = of;
        }
    };
    consider(pieces.splits, EventClass::PieceSplits);
    consider(pieces.births, EventClass::PieceComes);
    consider(pieces.deaths, EventClass::PieceGoes);
    return kind;
}

const char* nameOf(EventFilter filter) {
    switch (filter) {
        case EventFilter::All: return "All changes";
        case EventFilter::PiecesCome: return "Pieces appear";
        case EventFilter::PiecesGo: return "Pieces disappear";
        case EventFilter::PiecesJoin: return "Pieces join";
        case EventFilter::PiecesSplit: return "Pieces split";
        case EventFilter::Tunnels: return "Tunnels change";
        case EventFilter::Voids: return "Voids change";
        case EventFilter::Loops: return "Boundary loops change";
    }
    return "";
}

bool passes(EventFilter filter, const TopologyEvent& event) {
    const int change = changeOfPieces(event);
    switch (filter) {
        case EventFilter::All: return true;
        case EventFilter::PiecesCome: return event.pieces.births > 0 || change > 0;
        case EventFilter::PiecesGo: return event.pieces.deaths > 0 || change < 0;
        case EventFilter::PiecesJoin: return event.pieces.joins > 0 || change < 0;
        case EventFilter::PiecesSplit: return event.pieces.splits > 0 || change > 0;
        case EventFilter::Tunnels: return event.below.handles() != event.above.handles();
        case EventFilter::Voids: return event.below.voids != event.above.voids;
        case EventFilter::Loops: return event.below.loops != event.above.loops;
    }
    return true;
}

std::string wordsOf(const TopologyEvent& event) {
    std::string text;
    if (listsPieces(event)) {
        for (const auto& change : changesOfPieces(event))
            text += (text.empty() ? "" : ", ") + change;
    } else if (const int change = changeOfPieces(event); change != 0) {
        text = change > 0 ? "pieces appear or split" : "pieces join or go";
    } else {
        text = changeOfOthers(event);
    }
    if (text.front() >= 'a' && text.front() <= 'z')
        text.front() = static_cast<char>(text.front() - 'a' + 'A');
    return text;
}

std::string countsText(const SurfaceCounts& counts, bool areExact) {
    if (!areExact) // as samples are missing
        return "at least " + named(counts.components, "piece", "pieces") + " · " +
               named(counts.voids, "void", "voids") + " · at least " +
               named(counts.loops, "boundary loop", "boundary loops");
    return named(counts.components, "piece", "pieces") + " · " + named(counts.handles(), "tunnel", "tunnels") + " · " +
           named(counts.voids, "void", "voids") + " · " + named(counts.loops, "boundary loop", "boundary loops");
}

std::string changeText(std::int64_t below, std::int64_t above) {
    return below == above ? groupedText(below) : groupedText(below) + " → " + groupedText(above);
}

std::string describe(const TopologyEvent& event) {
    return "Isovalue " + valueText(event.isovalue, 7) + "\n" + wordsOf(event) +
           (event.persistence > 0.0 ? "\nPersistence " + valueText(event.persistence, 4) : std::string()) +
           "\nBefore: " + countsText(event.below) + "\nAfter: " + countsText(event.above);
}

} // namespace isoslider::model
