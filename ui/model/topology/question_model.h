#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"
#include "ui/model/topology/isovalue_query.h"
#include "ui/model/topology/topology_model.h"

namespace isoslider::model {

enum class QuestionState { Empty, Invalid, Searching, Failed, Answered };

/// Which isovalues the user looks for, and which there are. Events are searched on a worker's thread, for the newest
/// question only; another volume takes the answer away and is searched again. Window thread only.
class QuestionModel {
public:
    QuestionModel(const TopologyModel& topology, std::shared_ptr<BackgroundJobs> jobs);

    QueryQuantity quantity() const { return quantity_; }
    const std::string& typed() const { return typed_; }
    void ask(QueryQuantity quantity, std::string typed);

    QuestionState state() const { return state_; }
    /// Why there is no answer: one line; of Invalid and Failed.
    const std::string& problem() const { return problem_; }
    /// Of Answered; those of the question before while the next one is searched for.
    const FoundIsovalues& found() const { return found_; }
    /// "2 intervals", "No isovalue has 7 pieces; the most is 5": of any state. `unit` may be empty: not known.
    std::string answerText(const std::string& unit) const;

    const Observable<>& changed() const { return changed_; }

private:
    void search();
    void settle(QuestionState state, std::string problem = {});
    std::string nothingText(const std::string& unit) const;

    const TopologyModel& topology_;
    QueryQuantity quantity_ = QueryQuantity::Pieces;
    std::string typed_;
    IsovalueQuery query_;
    QuestionState state_ = QuestionState::Empty;
    std::string problem_;
    FoundIsovalues found_;
    std::shared_ptr<const topology::TopologySummary> searched_;
    ObserverList<> changed_;
    Subscription topologySubscription_;
    LatestJob<FoundIsovalues> job_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
