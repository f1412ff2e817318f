#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/topology/topology_queries.h"

namespace isoslider::model {

/// What isovalues can be looked for by.
enum class QueryQuantity { Pieces, Tunnels, Voids, Loops, Area, Volume };
inline constexpr int kQueryQuantities = 6;

/// Counted at every isovalue, not measured at some.
bool isCount(QueryQuantity quantity);
/// "pieces", "area"
const char* nameOf(QueryQuantity quantity);
/// The power of the unit of length: 2 of areas, 3 of volumes, 0 of counts.
int lengthPower(QueryQuantity quantity);
/// Whether it is known of a volume at all.
bool isKnown(const topology::TopologySummary& summary, QueryQuantity quantity);
/// At an isovalue. REQUIRES: isKnown(). Errors: those of reading events.
Result<double> valueAt(const topology::TopologySummary& summary, QueryQuantity quantity, double isovalue);

/// Isovalues whose surface has `value` of a quantity.
struct IsovalueQuery {
    QueryQuantity quantity = QueryQuantity::Pieces;
    double value = 0.0;
};
/// What is typed for a quantity: a whole number for a count, none of them negative. Thousands may be separated by
/// commas. Errors: InvalidArgument, with a line for whoever typed.
Result<IsovalueQuery> queryOf(QueryQuantity quantity, const std::string& typed);

struct FoundIsovalues {
    /// Ascending. Of counts, isovalues beyond `below` and up to `above`; of measures both are the isovalue.
    std::vector<topology::IsovalueInterval> intervals;
    std::uint64_t count = 0; ///< of all that there are
    double least = 0.0, greatest = 0.0; ///< of the quantity, at any isovalue that has a surface
};
/// Of more intervals, so many of the widest are kept.
inline constexpr std::size_t kMostFound = 200;
/// REQUIRES: isKnown(). O(events). Errors: those of reading events.
Result<FoundIsovalues> findIsovalues(const topology::TopologySummary& summary, const IsovalueQuery& query);

/// Where to go to see it: the middle, which is always within.
double isovalueIn(const topology::IsovalueInterval& interval);
/// "12.5 … 20", or the isovalue alone.
std::string intervalText(const topology::IsovalueInterval& interval);

} // namespace isoslider::model
