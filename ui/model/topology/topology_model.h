#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/topology/change_sums.h"
#include "core/topology/topology_queries.h"
#include "ui/model/observers.h"
#include "ui/model/topology/event_words.h"

namespace isoslider::model {

enum class TopologyState { None, Analysing, Ready, Failed };

/// What may be drawn over the histogram.
enum class TopologyQuantity { Pieces, Tunnels, Area, Volume, Triangles, Gradient };
inline constexpr std::size_t kTopologyQuantities = 6;

/// Values at isovalues that ascend.
struct TopologyCurve {
    std::vector<double> isovalues, values;
};

/// What the window shows of the topology of the volume that is open: its most notable events, those among them that
/// last long enough, the one that was chosen, and counts at any isovalue. Window thread only.
///
/// What is called persistence here is an event's weight (topology::WeightedEvent): so events of tunnels, voids and
/// loops, at which no piece comes or goes, are ranked beside those of pieces.
class TopologyModel {
public:
    /// Of more events those of the greatest weight are listed.
    static constexpr std::size_t kMostListed = 20'000;

    /// The summary with what is listed of it, made on a worker's thread.
    struct Content {
        std::shared_ptr<const topology::TopologySummary> summary;
        std::vector<topology::TopologyEvent> events; ///< ascending
        std::vector<double> persistences; ///< of each: its weight
        /// Counts at even steps from the first event of all to the last, to be drawn.
        std::vector<double> isovalues;
        std::vector<topology::SurfaceCounts> counts;
        std::vector<topology::Suggestion> suggestions; ///< the best first
        topology::ChangeSums changes;
    };
    static Result<Content> contentOf(std::shared_ptr<const topology::TopologySummary> summary);

    TopologyState state() const { return state_; }
    /// Why there is none: one line.
    const std::string& problem() const { return problem_; }
    void clear();
    void setAnalysing();
    void setFailed(std::string problem);
    void setContent(Content content);

    /// Null while it is not there.
    const std::shared_ptr<const topology::TopologySummary>& summary() const { return content_.summary; }
    const topology::ChangeSums& changes() const { return content_.changes; }
    /// Isovalues worth a look, the best first.
    const std::vector<topology::Suggestion>& suggestions() const { return content_.suggestions; }
    /// False where memory sufficed for counts and curves only.
    bool hasEvents() const { return !content_.summary || content_.summary->hasEvents(); }
    /// Whether there are counts of any surface.
    bool hasCounts() const { return !content_.counts.empty(); }
    /// Of all, listed or not.
    std::uint64_t eventCount() const { return content_.summary && hasEvents() ? content_.summary->eventCount() : 0; }
    /// Ascending by isovalue.
    const std::vector<topology::TopologyEvent>& events() const { return content_.events; }
    /// REQUIRES: event < events().size().
    double persistenceOf(std::size_t event) const { return content_.persistences[event]; }
    /// Finite.
    double greatestPersistence() const { return greatestPersistence_; }
    /// Events that last less are not shown.
    double leastPersistence() const { return leastPersistence_; }
    void setLeastPersistence(double persistence);
    /// Persistences on a logarithmic scale from 0 to 1, where 1 is the greatest and 0 stands for 0.
    double persistenceAt(double fraction) const;
    double fractionOf(double persistence) const;
    /// Events of another kind are not shown.
    EventFilter eventFilter() const { return eventFilter_; }
    void setEventFilter(EventFilter filter);
    /// Places in events() of those that are shown, ascending by isovalue.
    const std::vector<std::size_t>& shown() const { return shown_; }

    /// The first shown event that lies beyond what `isovalue` shows: moving just past it changes the surface's
    /// topology.
    std::optional<std::size_t> next(double isovalue) const;
    /// The last shown event that moving just past is a move down to.
    std::optional<std::size_t> previous(double isovalue) const;
    /// The most persistent of the shown events that a move from one isovalue to another goes past, either way.
    /// O(log(shown) + passed).
    std::optional<std::size_t> passed(double from, double to) const;
    /// The least isovalue at which the event has happened: the next double.
    double justPast(std::size_t event) const;

    /// The one that was chosen last, in a list or by a key: marked in the view.
    std::optional<std::size_t> chosen() const { return chosen_; }
    void choose(std::optional<std::size_t> event);

    /// False where samples are missing such that pieces and loops are only bounded, and tunnels not known.
    bool areCountsExact() const { return !content_.summary || content_.summary->areCountsExact(); }
    /// None while there are no counts.
    std::optional<topology::SurfaceCounts> countsAt(double isovalue) const;
    /// Values of one quantity over the value range, to be drawn; empty where it is not known.
    TopologyCurve curve(TopologyQuantity quantity) const;
    bool hasCurve(TopologyQuantity quantity) const;
    std::optional<double> valueAt(TopologyQuantity quantity, double isovalue) const;

    const Observable<>& changed() const { return changed_; } ///< state, content or filter
    const Observable<>& chosenChanged() const { return chosenChanged_; }

private:
    void filter();

    TopologyState state_ = TopologyState::None;
    std::string problem_;
    Content content_;
    double greatestPersistence_ = 0.0, leastPersistence_ = 0.0;
    EventFilter eventFilter_ = EventFilter::All;
    std::vector<std::size_t> shown_;
    std::optional<std::size_t> chosen_;
    ObserverList<> changed_;
    ObserverList<> chosenChanged_;
};

} // namespace isoslider::model
