#include "ui/model/topology/isovalue_query.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

using topology::IsovalueInterval;
using topology::SurfaceCounts;
using topology::SurfaceMeasures;

constexpr double kMostCounted = 9e15; // beyond it, not every whole number is a double

std::int64_t countOf(const SurfaceCounts& counts, QueryQuantity quantity) {
    switch (quantity) {
        case QueryQuantity::Tunnels: return counts.handles();
        case QueryQuantity::Voids: return counts.voids;
        case QueryQuantity::Loops: return counts.loops;
        default: return counts.components;
    }
}

double SurfaceMeasures::*measureOf(QueryQuantity quantity) {
    return quantity == QueryQuantity::Area ? &SurfaceMeasures::area : &SurfaceMeasures::volume;
}

double halfWidth(const IsovalueInterval& interval) { return 0.5 * interval.above - 0.5 * interval.below; }

void keepWidest(std::vector<IsovalueInterval>& intervals) {
    if (intervals.size() <= kMostFound)
        return;
    const auto end = intervals.begin() + kMostFound;
    std::nth_element(intervals.begin(), end, intervals.end(), [](const IsovalueInterval& a, const IsovalueInterval& b) {
        return halfWidth(a) != halfWidth(b) ? halfWidth(a) > halfWidth(b) : a.below < b.below;
    });
    intervals.erase(end, intervals.end());
    std::sort(intervals.begin(), intervals.end(),
              [](const IsovalueInterval& a, const IsovalueInterval& b) { return a.below < b.below; });
}

Result<FoundIsovalues> findCounts(const topology::TopologySummary& summary, const IsovalueQuery& query) {
    FoundIsovalues found;
    bool isFirst = true;
    auto intervals = topology::intervalsWith(summary, [&](const SurfaceCounts& counts) {
        const auto count = static_cast<double>(countOf(counts, query.quantity));
        found.least = isFirst ? count : std::min(found.least, count);
        found.greatest = isFirst ? count : std::max(found.greatest, count);
        isFirst = false;
        return count == query.value;
    });
    if (!intervals.isOk())
        return std::move(intervals).error();
    found.intervals = std::move(intervals).value();
    return found;
}

FoundIsovalues findMeasures(const topology::MeasureCurves& curves, const IsovalueQuery& query) {
    FoundIsovalues found;
    const auto measure = measureOf(query.quantity);
    for (const double isovalue : topology::isovaluesWith(curves, measure, query.value))
        found.intervals.push_back({isovalue, isovalue});
    found.least = found.greatest = curves.measures.front().*measure;
    for (const SurfaceMeasures& at : curves.measures) {
        found.least = std::min(found.least, at.*measure);
        found.greatest = std::max(found.greatest, at.*measure);
    }
    return found;
}

} // namespace

bool isCount(QueryQuantity quantity) { return lengthPower(quantity) == 0; }

const char* nameOf(QueryQuantity quantity) {
    switch (quantity) {
        case QueryQuantity::Pieces: return "pieces";
        case QueryQuantity::Tunnels: return "tunnels";
        case QueryQuantity::Voids: return "voids";
        case QueryQuantity::Loops: return "boundary loops";
        case QueryQuantity::Area: return "area";
        case QueryQuantity::Volume: return "volume above";
    }
    return "";
}

int lengthPower(QueryQuantity quantity) {
    return quantity == QueryQuantity::Area ? 2 : quantity == QueryQuantity::Volume ? 3 : 0;
}

bool isKnown(const topology::TopologySummary& summary, QueryQuantity quantity) {
    if (!isCount(quantity))
        return !summary.curves().isEmpty();
    return summary.eventCount() > 0 && (quantity != QueryQuantity::Tunnels || summary.areCountsExact());
}

Result<double> valueAt(const topology::TopologySummary& summary, QueryQuantity quantity, double isovalue) {
    if (!isCount(quantity))
        return summary.curves().at(isovalue).*measureOf(quantity);
    const auto counts = summary.at(isovalue);
    if (!counts.isOk())
        return counts.error();
    return static_cast<double>(countOf(counts.value(), quantity));
}

Result<IsovalueQuery> queryOf(QueryQuantity quantity, const std::string& typed) {
    std::string digits;
    for (const char c : typed)
        if (c != ',' && c != ' ')
            digits += c;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool isNumber = error == std::errc() && end == digits.data() + digits.size() && std::isfinite(value);
    if (!isNumber)
        return makeError(ErrorCode::InvalidArgument, isCount(quantity) ? "Type a whole number" : "Type a number");
    if (isCount(quantity) && (value != std::floor(value) || value > kMostCounted))
        return makeError(ErrorCode::InvalidArgument, "Only whole numbers are counted");
    if (value < 0.0)
        return makeError(ErrorCode::InvalidArgument, "It is never negative");
    return IsovalueQuery{quantity, value};
}

Result<FoundIsovalues> findIsovalues(const topology::TopologySummary& summary, const IsovalueQuery& query) {
    auto found = isCount(query.quantity) ? findCounts(summary, query)
                                         : Result<FoundIsovalues>(findMeasures(summary.curves(), query));
    if (found.isOk()) {
        found.value().count = found.value().intervals.size();
        keepWidest(found.value().intervals);
    }
    return found;
}

double isovalueIn(const IsovalueInterval& interval) {
    const double middle = 0.5 * interval.below + 0.5 * interval.above;
    return middle > interval.below && middle < interval.above ? middle : interval.above;
}

std::string intervalText(const IsovalueInterval& interval) {
    const std::string below = valueText(interval.below, 7), above = valueText(interval.above, 7);
    return below == above ? above : below + " … " + above;
}

} // namespace isoslider::model
