#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"
#include "ui/model/session/session.h"
#include "ui/model/slices/cap_samples.h"
#include "ui/model/slices/slice_options.h"
#include "ui/model/slices/slice_source.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {

/// Samples on one of the clip planes, while it has a cap. They are taken by background jobs, one at a time, for the
/// plane that is wanted when the job begins; so a fast drag shows caps on its way and ends at the newest. Window thread
/// only; everything it is given must outlive it.
class CapModel {
public:
    CapModel(Session& session, const ViewState& view, std::size_t place);
    CapModel(const CapModel&) = delete;
    CapModel& operator=(const CapModel&) = delete;

    /// Null until they are there, and while no cap is wanted; perhaps still of another plane.
    std::shared_ptr<const CapSamples> samples() const { return samples_; }
    /// The values that are black and white.
    ValueWindow window() const;
    /// Why there are none; empty while there are, or they are on their way.
    const std::string& problem() const { return problem_; }
    /// What is wanted is there, or cannot be had.
    bool isSettled() const;
    /// Looks again at what is wanted.
    void refresh();
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

private:
    /// What samples are read from; changes when the index takes over from the volume in memory.
    struct Source {
        DatasetGeneration dataset{};
        bool isInMemory = false;
        std::int64_t step = 1; ///< of a preview

        bool operator==(const Source&) const = default;
    };

    const ClipPlane& plane() const { return view_.options().clipping.planes[place_]; }
    bool isWanted() const;
    void chooseSource();
    void openSource();
    void sample();
    void setProblem(std::string problem);
    void forget();

    Session& session_;
    const ViewState& view_;
    std::size_t place_; ///< of the plane
    std::optional<Source> source_, sampled_; ///< the second of samples_
    std::shared_ptr<extract::SliceSampler> sampler_;
    std::shared_ptr<const CapSamples> samples_;
    std::optional<ClipPlane> failed_; ///< is not tried again
    bool isOpening_ = false, isSampling_ = false;
    std::string problem_;
    ObserverList<> changed_;
    std::shared_ptr<BackgroundJobs> jobs_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
