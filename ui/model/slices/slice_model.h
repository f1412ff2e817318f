#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/extract/slices/slice_sampler.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/slices/slice_geometry.h"
#include "ui/model/slices/slice_options.h"
#include "ui/model/slices/slice_picture.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

class Session;

/// Where the surfaces on screen cross a slice: two points for each line.
struct SliceContour {
    struct Part {
        std::size_t pointEnd = 0; ///< one past its last point
        SurfaceColour colour{}; ///< as seen; of a volume's only surface that of the handle
        bool operator==(const Part&) const = default;
    };
    std::vector<glm::vec3> points; ///< grid index units of the volume, part after part
    std::vector<Part> parts; ///< the active surface's last
};

/// What a pointer is over.
struct SliceReading {
    glm::dvec3 place{0.0}; ///< grid index units
    glm::dvec3 world{0.0}; ///< units of the file
    std::optional<double> value; ///< none: missing
};

/// The slices of the volume that is open: what is asked for, and what is there of it. Samples and contours are made by
/// background jobs, one of each at a time, for what is wanted when the job begins; so a fast drag shows pictures on its
/// way and ends at the newest. Window thread only.
class SliceModel {
public:
    explicit SliceModel(Session& session);
    ~SliceModel();
    SliceModel(const SliceModel&) = delete;
    SliceModel& operator=(const SliceModel&) = delete;

    const SliceOptions& options() const { return options_; }
    /// All that is kept of slices is set here, and nowhere else. What is out of bounds is brought into them.
    void setOptions(const SliceOptions& options);
    void change(const std::function<void(SliceOptions&)>& change);
    /// So many slices on, within the volume.
    void step(SliceKind kind, double steps);
    /// Lets all slices meet at a place, at a grid point if `snaps`.
    void moveTo(const glm::dvec3& place, bool snaps = true);
    /// In the middle of the volume, as it was when it was opened.
    void resetPosition();

    bool isInPane(SliceKind kind) const;
    /// In a pane or in the 3-D view.
    bool isShown(SliceKind kind) const { return isInPane(kind) || options_.inScene[placeOf(kind)]; }
    /// Of any slice that is shown.
    bool showsContours() const;
    /// Null without a volume.
    const Dataset* dataset() const;
    /// The one asked for, or the one chosen by the values.
    ValueWindow window() const;
    /// As asked for. REQUIRES: dataset().
    extract::SlicePlane planeOf(SliceKind kind) const;
    SliceLabels labels(SliceKind kind) const;
    /// Whether the world's axes are a patient's.
    bool isPatient() const;

    /// Null until it is there; perhaps still of another position. Made when first asked for.
    std::shared_ptr<const SliceShades> shades(SliceKind kind);
    std::shared_ptr<const SliceContour> contour(SliceKind kind) const;
    /// Above 1: its samples are those of a preview, every n-th along each axis.
    std::int64_t shownStep(SliceKind kind) const { return slices_[placeOf(kind)].source.step; }
    /// Of the sample nearest to a pixel of the slice on screen; none outside the volume.
    std::optional<SliceReading> reading(SliceKind kind, double column, double row) const;
    /// Why there are no samples of the slice as asked for; empty while there are, or they are on their way.
    std::string problem(SliceKind kind) const;
    /// All that is shown is there, as asked for.
    bool isSettled() const;

    /// Told when options() have changed, or what they refer to.
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }
    /// Told when a slice has other samples, another contour or another problem.
    [[nodiscard]] Subscription observePictures(std::function<void()> function) {
        return pictures_.observe(std::move(function));
    }

private:
    /// What samples are read from; changes when the index takes over from the volume in memory.
    struct Source {
        DatasetGeneration dataset{};
        bool isInMemory = false;
        std::int64_t step = 1; ///< of a preview

        bool operator==(const Source&) const = default;
    };
    struct Slice {
        std::shared_ptr<const extract::SliceSamples> samples; ///< its plane is in units of the volume
        Source source;
        std::optional<extract::SlicePlane> failed; ///< is not tried again
        std::string problem; ///< of that
        std::shared_ptr<const SliceShades> shades;
        ValueWindow shadesWindow;
        std::shared_ptr<const SliceContour> contour;
        extract::SlicePlane contourPlane;
        std::uint64_t contourSurfaces = 0;
    };

    void followDataset();
    void refresh();
    void chooseSource();
    void openSource();
    void sampleNext();
    void cutNext();
    bool needsSamples(SliceKind kind) const;
    bool needsContour(SliceKind kind) const;
    void setProblem(std::string problem);
    /// A surface that is cut.
    struct CutSurface {
        std::shared_ptr<const extract::SurfaceFrame> frame;
        HiddenPieces hidden;
        SurfaceColour colour{};
    };
    std::vector<CutSurface> shownSurfaces() const;
    void noteSurfaces();

    Session& session_;
    SliceOptions options_;
    std::array<Slice, 4> slices_;
    DatasetGeneration dataset_{};
    std::optional<Source> source_;
    std::shared_ptr<extract::SliceSampler> sampler_;
    std::uint64_t surfaces_ = 1; ///< counts changes of what is cut
    std::vector<CutSurface> cut_; ///< what it is
    bool isOpening_ = false, isSampling_ = false, isCutting_ = false;
    std::size_t lastSampled_ = 0, lastCut_ = 0; ///< kinds take turns
    std::string problem_; ///< of all
    ObserverList<> changed_;
    ObserverList<> pictures_;
    Subscription datasetSubscription_;
    Subscription frameSubscription_;
    Subscription surfacesSubscription_;
    Subscription inactiveSubscription_;
    std::shared_ptr<BackgroundJobs> jobs_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
