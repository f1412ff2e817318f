#include "ui/model/isovalue/histogram_view.h"

#include <algorithm>
#include <cmath>

#include "ui/model/isovalue/value_steps.h"

namespace isoslider::model {
namespace {

constexpr double kTowers = 4.0; // so many times the others' height
constexpr double kFewColumns = 0.02;

bool isAtOneValue(const ValueCell& cell) { return cell.lower == cell.upper; }

} // namespace

double HistogramView::binWidth() const {
    const auto& body = values_->body;
    return body.counts.empty() ? 0.0 : (body.max - body.min) / static_cast<double>(body.counts.size());
}

std::uint64_t HistogramView::weighted(double count) const {
    return static_cast<std::uint64_t>(std::llround(std::min(count * values_->weight, 9e18)));
}

HistogramView::Range HistogramView::usualRange() const {
    if (values_->isEmpty())
        return wholeRange();
    Range range{std::max(values_->body.min, values_->min - values_->spacing / 2.0),
                std::min(values_->body.max, values_->max + values_->spacing / 2.0)};
    return range.lower < range.upper ? range : wholeRange();
}

HistogramView::Range HistogramView::wholeRange() const {
    const double half = values_->spacing / 2.0;
    return {values_->min - half, values_->max + half};
}

bool HistogramView::hasOutliers() const {
    const Range usual = usualRange();
    return values_->min < usual.lower || values_->max > usual.upper;
}

HistogramView::Beyond HistogramView::beyond(const Range& range) const {
    double below = 0.0, above = 0.0;
    for (const ValueCell& cell : values_->cells) {
        const double width = cell.upper - cell.lower;
        const auto share = [&](double part) { return std::clamp(part / width, 0.0, 1.0); };
        const auto count = static_cast<double>(cell.count);
        if (isAtOneValue(cell) || !(width > 0.0)) {
            below += cell.lower < range.lower ? count : 0.0;
            above += cell.lower > range.upper ? count : 0.0;
            continue;
        }
        below += cell.upper <= range.lower ? count : count * share(range.lower - cell.lower);
        above += cell.lower >= range.upper ? count : count * share(cell.upper - range.upper);
    }
    // Exact at the ends of the body, where views begin.
    if (range.lower <= values_->body.min)
        below = std::min(below, static_cast<double>(values_->below));
    if (range.upper >= values_->body.max)
        above = std::min(above, static_cast<double>(values_->above));
    return {weighted(below), weighted(above)};
}

HistogramView::Outline HistogramView::bodyOutline(double lower, double upper, int columns) const {
    const auto& body = values_->body;
    const double width = binWidth();
    const auto bins = static_cast<double>(body.counts.size());
    const double perColumn = (upper - lower) / std::max(1, columns) / width;
    // Whole numbers of bins in a column, from the first bin on: the same columns wherever the view is moved. Of values
    // that are all next to zero a view may hold more columns than any number of bins.
    const auto merged = static_cast<std::size_t>(std::min(bins, std::max(1.0, std::ceil(perColumn - 1e-9))));
    const auto clamped = [&](double bin) { return static_cast<std::size_t>(std::clamp(bin, 0.0, bins)); };
    std::size_t bin = clamped(std::floor((lower - body.min) / width)) / merged * merged;
    const std::size_t end = clamped(std::ceil((upper - body.min) / width));
    Outline outline;
    for (; bin < end; bin += merged) {
        double count = 0.0;
        const std::size_t last = std::min(bin + merged, body.counts.size());
        for (std::size_t part = bin; part < last; ++part)
            count += static_cast<double>(body.counts[part]);
        outline.places.push_back(body.min + width * static_cast<double>(bin));
        outline.counts.push_back(count * values_->weight);
        if (last == body.counts.size() || bin + merged >= end) {
            outline.places.push_back(body.min + width * static_cast<double>(last));
            break;
        }
    }
    return outline;
}

// Each cell is spread over the columns that it covers.
HistogramView::Outline HistogramView::cellOutline(const ValueScale& scale, double lowerPlace, double upperPlace,
                                                  int columns) const {
    Outline outline;
    outline.counts.assign(static_cast<std::size_t>(columns), 0.0);
    outline.isShared = !values_->isEachValue || values_->spacing > 0.0;
    const double width = (upperPlace - lowerPlace) / columns;
    for (int column = 0; column <= columns; ++column)
        outline.places.push_back(lowerPlace + width * column);
    const double half = values_->isEachValue ? values_->spacing / 2.0 : 0.0;
    for (const ValueCell& cell : values_->cells) {
        double begin = (scale.placeOf(isAtOneValue(cell) ? cell.lower - half : cell.lower) - lowerPlace) / width;
        double end = (scale.placeOf(isAtOneValue(cell) ? cell.upper + half : cell.upper) - lowerPlace) / width;
        if (end < 0.0 || begin > columns)
            continue;
        if (scale.kind() == ScaleKind::Log && cell.lower - half <= 0.0)
            begin = std::max(begin, (scale.placeOf(std::max(cell.lower, 1e-300)) - lowerPlace) / width - 0.5);
        if (end - begin < (isAtOneValue(cell) ? 1.0 : 1e-6)) {
            const double middle = (begin + end) / 2.0;
            if (middle >= 0.0 && middle < columns)
                outline.counts[static_cast<std::size_t>(middle)] += static_cast<double>(cell.count) * values_->weight;
            continue;
        }
        const double perColumn = static_cast<double>(cell.count) * values_->weight / std::max(end - begin, 1e-12);
        const int first = std::max(0, static_cast<int>(std::floor(begin)));
        const int last = std::min(columns - 1, static_cast<int>(std::floor(end)));
        for (int column = first; column <= last; ++column) {
            const double covered = std::min(end, column + 1.0) - std::max(begin, static_cast<double>(column));
            outline.counts[static_cast<std::size_t>(column)] += perColumn * std::max(0.0, covered);
        }
    }
    return outline;
}

HistogramView::Outline HistogramView::outline(const ValueScale& scale, double lowerPlace, double upperPlace,
                                              int columns) const {
    if (values_->isEmpty() || columns < 1 || !(upperPlace > lowerPlace))
        return {};
    const auto& body = values_->body;
    const double slack = 0.05 * (body.max - body.min);
    const bool isInBody = lowerPlace >= body.min - slack && upperPlace <= body.max + slack;
    if (scale.kind() == ScaleKind::Linear && (isInBody || !hasOutliers()) && binWidth() > 0.0 &&
        std::isfinite(binWidth()))
        return bodyOutline(lowerPlace, upperPlace, columns);
    return cellOutline(scale, lowerPlace, upperPlace, columns);
}

HistogramView::Top HistogramView::topOf(const Outline& outline, bool clips) {
    std::vector<double> counts;
    for (const double count : outline.counts)
        if (count > 0.0)
            counts.push_back(count);
    if (counts.empty())
        return {};
    std::sort(counts.begin(), counts.end(), std::greater<>());
    const auto few = static_cast<std::size_t>(std::max(1.0, kFewColumns * static_cast<double>(counts.size())));
    if (!clips || counts.size() <= few || counts.front() < kTowers * counts[few])
        return {counts.front() * 1.05, false};
    return {counts[few] * 1.4, true};
}

std::optional<HistogramView::Readout> HistogramView::readout(double value) const {
    if (values_->isEmpty() || !std::isfinite(value) || value < wholeRange().lower || value > wholeRange().upper)
        return std::nullopt;
    Readout out;
    out.isExact = values_->isExact();
    const auto& body = values_->body;
    const double width = binWidth();
    double below = 0.0;
    const auto countAll = static_cast<double>(values_->counted());
    if (width > 0.0 && value >= body.min && value <= body.max) {
        const auto bin = std::min(static_cast<std::size_t>((value - body.min) / width), body.counts.size() - 1);
        below = static_cast<double>(values_->below);
        for (std::size_t b = 0; b < bin; ++b)
            below += static_cast<double>(body.counts[b]);
        out.lower = body.min + width * static_cast<double>(bin);
        out.upper = out.lower + width;
        out.count = weighted(static_cast<double>(body.counts[bin]));
        if (values_->spacing > 0.0 && width < 1.5 * values_->spacing) {
            out.lower = out.upper = nearestMultiple((out.lower + out.upper) / 2.0, values_->spacing == 1.0 ? 1.0 : 0.0);
            below += value > out.lower ? static_cast<double>(body.counts[bin]) : 0.0;
        } else {
            below += static_cast<double>(body.counts[bin]) * (value - out.lower) / width;
        }
    } else {
        out.lower = out.upper = value;
        for (const ValueCell& cell : values_->cells) {
            if (cell.upper < value || (isAtOneValue(cell) && cell.lower < value))
                below += static_cast<double>(cell.count);
            else if (cell.lower <= value) {
                out.lower = cell.lower;
                out.upper = cell.upper;
                out.count = weighted(static_cast<double>(cell.count));
            }
        }
    }
    out.shareBelow = countAll > 0.0 ? below / countAll : 0.0;
    return out;
}

// Of whole numbers and of values that are known, the first and the last that a step has.
void HistogramView::narrowToSamples(Readout& readout) const {
    if (values_->spacing == 1.0) {
        const double first = std::ceil(readout.lower), last = std::ceil(readout.upper) - 1.0;
        if (first <= last) {
            readout.lower = first;
            readout.upper = last;
        }
        return;
    }
    if (!values_->isEachValue)
        return;
    const auto& cells = values_->cells;
    const auto at = [&](double value) {
        return std::lower_bound(cells.begin(), cells.end(), value,
                                [](const ValueCell& cell, double v) { return cell.lower < v; });
    };
    const auto first = at(readout.lower), end = at(readout.upper);
    if (std::distance(first, end) == 1)
        readout.lower = readout.upper = first->lower;
}

std::optional<HistogramView::Readout> HistogramView::readout(const Outline& outline, const ValueScale& scale,
                                                             double place) const {
    auto out = readout(scale.valueAt(place));
    const auto end = std::upper_bound(outline.places.begin(), outline.places.end(), place);
    if (!out || end == outline.places.begin() || end == outline.places.end())
        return out;
    const double lower = scale.valueAt(*std::prev(end)), upper = scale.valueAt(*end);
    const bool isOfOneValue = out->lower == out->upper && upper - lower < 1.5 * values_->spacing;
    if (isOfOneValue || !std::isfinite(lower) || !std::isfinite(upper))
        return out;
    const auto column = static_cast<std::size_t>(std::distance(outline.places.begin(), end)) - 1;
    out->lower = lower;
    out->upper = upper;
    out->count = static_cast<std::uint64_t>(std::llround(std::min(outline.counts[column], 9e18)));
    out->isExact = out->isExact && !outline.isShared;
    narrowToSamples(*out);
    return out;
}

std::optional<double> HistogramView::nearestSample(double value) const {
    if (!knowsSamples())
        return std::nullopt;
    if (!values_->isEachValue)
        return std::clamp(nearestMultiple(value, values_->spacing), values_->min, values_->max);
    const auto& cells = values_->cells;
    const auto above = std::lower_bound(cells.begin(), cells.end(), value,
                                        [](const ValueCell& cell, double v) { return cell.lower < v; });
    if (above == cells.end())
        return cells.back().lower;
    if (above == cells.begin())
        return above->lower;
    const double before = std::prev(above)->lower;
    return value - before < above->lower - value ? before : above->lower;
}

std::optional<double> HistogramView::nextSample(double value, bool isUpwards) const {
    if (!knowsSamples())
        return std::nullopt;
    if (!values_->isEachValue) {
        const double step = values_->spacing;
        const double next = isUpwards ? steppedBy(value, 1.0, step) : steppedBy(value, -1.0, step);
        return std::clamp(next, values_->min, values_->max);
    }
    const auto& cells = values_->cells;
    if (isUpwards) {
        const auto above = std::upper_bound(cells.begin(), cells.end(), value,
                                            [](double v, const ValueCell& cell) { return v < cell.lower; });
        return above == cells.end() ? cells.back().lower : above->lower;
    }
    const auto above = std::lower_bound(cells.begin(), cells.end(), value,
                                        [](const ValueCell& cell, double v) { return cell.lower < v; });
    return above == cells.begin() ? cells.front().lower : std::prev(above)->lower;
}

} // namespace isoslider::model
