#include "ui/model/topology/topology_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace isoslider::model {
namespace {

// Enough for every pixel of a screen.
constexpr std::size_t kCurvePoints = 1500;
constexpr double kFirstShare = 0.02; // of the greatest persistence: what is shown at first
constexpr double kDecades = 6.0; // of the scale of persistences

bool isMeasured(TopologyQuantity quantity) {
    return quantity != TopologyQuantity::Pieces && quantity != TopologyQuantity::Tunnels;
}

double valueOf(TopologyQuantity quantity, const topology::SurfaceMeasures& measures) {
    switch (quantity) {
        case TopologyQuantity::Area: return measures.area;
        case TopologyQuantity::Volume: return measures.volume;
        case TopologyQuantity::Triangles: return measures.triangles;
        default: return measures.gradient;
    }
}

// Many pages of a stored summary are read for it: not work for the window's thread.
Status drawCounts(TopologyModel::Content& content) {
    const auto ends = content.summary->ends();
    if (!ends.isOk())
        return ends.error();
    if (!ends.value())
        return {};
    const auto [first, last] = *ends.value();
    for (std::size_t i = 0; i <= kCurvePoints; ++i) {
        const double part = static_cast<double>(i) / kCurvePoints, isovalue = first * (1.0 - part) + last * part;
        const auto counts = content.summary->at(isovalue);
        if (!counts.isOk())
            return counts.error();
        content.isovalues.push_back(isovalue);
        content.counts.push_back(counts.value());
    }
    return {};
}

} // namespace

Result<TopologyModel::Content> TopologyModel::contentOf(std::shared_ptr<const topology::TopologySummary> summary) {
    const auto events = summary->mostNotable(kMostListed);
    if (!events.isOk())
        return events.error();
    Content content;
    content.summary = std::move(summary);
    for (const auto& [event, weight] : events.value()) {
        content.events.push_back(event);
        content.persistences.push_back(weight);
    }
    ISO_TRY(drawCounts(content));
    auto suggestions = topology::suggestIsovalues(*content.summary);
    if (!suggestions.isOk())
        return std::move(suggestions).error();
    content.suggestions = std::move(suggestions).value();
    auto changes = topology::ChangeSums::of(*content.summary);
    if (!changes.isOk())
        return std::move(changes).error();
    content.changes = std::move(changes).value();
    return content;
}

void TopologyModel::clear() {
    state_ = TopologyState::None;
    problem_.clear();
    content_ = {};
    greatestPersistence_ = leastPersistence_ = 0.0;
    filter();
    changed_.notify();
    choose(std::nullopt);
}

void TopologyModel::setAnalysing() {
    clear();
    state_ = TopologyState::Analysing;
    changed_.notify();
}

void TopologyModel::setFailed(std::string problem) {
    clear();
    state_ = TopologyState::Failed;
    problem_ = std::move(problem);
    changed_.notify();
}

void TopologyModel::setContent(Content content) {
    content_ = std::move(content);
    state_ = TopologyState::Ready;
    problem_.clear();
    greatestPersistence_ = 0.0;
    for (const double persistence : content_.persistences)
        greatestPersistence_ = std::max(greatestPersistence_, persistence);
    // Of two doubles of opposite sign the difference may be infinite.
    greatestPersistence_ = std::min(greatestPersistence_, std::numeric_limits<double>::max());
    if (content_.summary != nullptr && !content_.events.empty()) { // one outlier would make all others small
        const double first = content_.events.front().isovalue, last = content_.events.back().isovalue;
        const auto usual = topology::usualRange(content_.summary->curves(), first, last);
        if (usual.below > first || usual.above < last)
            greatestPersistence_ = std::min(greatestPersistence_, usual.above - usual.below);
    }
    leastPersistence_ = kFirstShare * greatestPersistence_;
    filter();
    changed_.notify();
    choose(std::nullopt);
}

void TopologyModel::setLeastPersistence(double persistence) {
    if (!(persistence >= 0.0) || persistence == leastPersistence_)
        return;
    leastPersistence_ = persistence;
    filter();
    changed_.notify();
}

void TopologyModel::setEventFilter(EventFilter filter) {
    if (filter == eventFilter_)
        return;
    eventFilter_ = filter;
    this->filter();
    changed_.notify();
}

double TopologyModel::persistenceAt(double fraction) const {
    return fraction > 0.0 ? greatestPersistence_ * std::pow(10.0, kDecades * (std::min(fraction, 1.0) - 1.0)) : 0.0;
}

double TopologyModel::fractionOf(double persistence) const {
    if (!(persistence > 0.0) || !(greatestPersistence_ > 0.0))
        return 0.0;
    return std::clamp(1.0 + (std::log10(persistence) - std::log10(greatestPersistence_)) / kDecades, 0.0, 1.0);
}

void TopologyModel::filter() {
    shown_.clear();
    for (std::size_t i = 0; i < content_.events.size(); ++i)
        if (content_.persistences[i] >= leastPersistence_ && passes(eventFilter_, content_.events[i]))
            shown_.push_back(i);
}

// An event at its isovalue has not happened yet.
std::optional<std::size_t> TopologyModel::next(double isovalue) const {
    const auto at = std::lower_bound(shown_.begin(), shown_.end(), isovalue, [this](std::size_t event, double value) {
        return content_.events[event].isovalue < value;
    });
    return at == shown_.end() ? std::nullopt : std::optional(*at);
}

std::optional<std::size_t> TopologyModel::previous(double isovalue) const {
    const auto at = std::lower_bound(shown_.begin(), shown_.end(), isovalue,
                                     [this](std::size_t event, double value) { return justPast(event) < value; });
    return at == shown_.begin() ? std::nullopt : std::optional(*std::prev(at));
}

std::optional<std::size_t> TopologyModel::passed(double from, double to) const {
    const auto firstFrom = [this](double isovalue) {
        return std::lower_bound(shown_.begin(), shown_.end(), isovalue, [this](std::size_t event, double value) {
            return content_.events[event].isovalue < value;
        });
    };
    const auto begin = firstFrom(std::min(from, to)), end = firstFrom(std::max(from, to));
    const auto most = std::max_element(begin, end, [this](std::size_t a, std::size_t b) {
        return content_.persistences[a] < content_.persistences[b];
    });
    return most == end ? std::nullopt : std::optional(*most);
}

double TopologyModel::justPast(std::size_t event) const {
    return std::nextafter(content_.events[event].isovalue, std::numeric_limits<double>::infinity());
}

void TopologyModel::choose(std::optional<std::size_t> event) {
    if (event && *event >= content_.events.size())
        event.reset();
    if (!event && !chosen_)
        return;
    chosen_ = event;
    chosenChanged_.notify();
}

std::optional<topology::SurfaceCounts> TopologyModel::countsAt(double isovalue) const {
    if (!content_.summary)
        return std::nullopt;
    const auto counts = content_.summary->at(isovalue);
    return counts.isOk() ? std::optional(counts.value()) : std::nullopt;
}

bool TopologyModel::hasCurve(TopologyQuantity quantity) const {
    if (!content_.summary)
        return false;
    if (isMeasured(quantity))
        return !content_.summary->curves().isEmpty();
    return hasCounts() && (quantity != TopologyQuantity::Tunnels || areCountsExact());
}

std::optional<double> TopologyModel::valueAt(TopologyQuantity quantity, double isovalue) const {
    if (!hasCurve(quantity))
        return std::nullopt;
    if (isMeasured(quantity))
        return valueOf(quantity, content_.summary->curves().at(isovalue));
    const auto counts = countsAt(isovalue);
    if (!counts)
        return std::nullopt;
    return static_cast<double>(quantity == TopologyQuantity::Pieces ? counts->components : counts->handles());
}

TopologyCurve TopologyModel::curve(TopologyQuantity quantity) const {
    TopologyCurve curve;
    if (!hasCurve(quantity))
        return curve;
    if (isMeasured(quantity)) {
        const auto& measured = content_.summary->curves();
        curve.isovalues = measured.isovalues;
        for (const auto& at : measured.measures)
            curve.values.push_back(valueOf(quantity, at));
        return curve;
    }
    curve.isovalues = content_.isovalues;
    for (const auto& counts : content_.counts)
        curve.values.push_back(
            static_cast<double>(quantity == TopologyQuantity::Pieces ? counts.components : counts.handles()));
    return curve;
}

} // namespace isoslider::model
