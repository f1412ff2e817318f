#pragma once

#include <string>

#include "core/topology/topology_event.h"

namespace isoslider::model {

/// What mainly happens to the surface where the isovalue rises beyond an event: the kinds that are drawn differently.
enum class EventClass { PieceComes, PieceGoes, PiecesJoin, PieceSplits, Other };
inline constexpr int kEventClasses = 5;

/// Of several changes at one isovalue the most frequent one; joins and splits come first among equals. Where no change
/// of pieces is listed, the number of pieces decides: more of them are PieceComes, fewer PieceGoes.
EventClass classOf(const topology::TopologyEvent& event);

/// Which events are listed.
enum class EventFilter { All, PiecesCome, PiecesGo, PiecesJoin, PiecesSplit, Tunnels, Voids, Loops };
inline constexpr int kEventFilters = 8;

/// "Pieces join".
const char* nameOf(EventFilter filter);
/// An event that changes the number of pieces in a way that is not listed may be either of two kinds: it passes both.
bool passes(EventFilter filter, const topology::TopologyEvent& event);

/// "A piece appears", "2 pieces appear, a piece splits", "3 tunnels open": as the isovalue rises.
std::string wordsOf(const topology::TopologyEvent& event);
/// "12 pieces · 3 tunnels · 1 void · 2 boundary loops"
std::string countsText(const topology::SurfaceCounts& counts, bool areExact = true);
/// "12 → 13", or "12" where nothing changes.
std::string changeText(std::int64_t below, std::int64_t above);
/// All that is known of an event, in lines: isovalue, what happens, persistence, counts below and above.
std::string describe(const topology::TopologyEvent& event);

} // namespace isoslider::model
