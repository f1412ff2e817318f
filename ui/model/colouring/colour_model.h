#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/model/colouring/surface_colours.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"

namespace isoslider::model {

/// What surfaces are coloured by, and the values for it. Positions are known at once; a field is made by a job that
/// stands among the session's, and the surface has its plain colour until then. What cannot be had is refused: a notice
/// states why, and the colouring becomes again what it was. Window thread only; everything it is given must outlive it.
class ColourModel {
public:
    ColourModel(Session& session, ViewState& view);
    ColourModel(const ColourModel&) = delete;
    ColourModel& operator=(const ColourModel&) = delete;

    /// As it can be drawn now.
    const SurfaceColours& colours() const { return colours_; }
    const Colouring& wanted() const { return view_.options().colouring; }
    /// The values are on their way.
    bool isMaking() const { return making_.has_value(); }
    /// What the colours stand for, and its unit, which may be empty.
    std::string title() const;
    std::string unit() const;
    /// "Shown at 1/4 of the resolution": what is less than all samples; else empty.
    std::string note() const;

    void choose(ColourBy by, const std::optional<FieldFile>& field = {});
    void change(const std::function<void(Colouring&)>& change);
    /// The range becomes that of the values on the active surface, as soon as a job has found it.
    void fitToSurface();
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

private:
    /// All that a field depends on.
    struct Key {
        DatasetGeneration dataset{};
        ColourBy by = ColourBy::One;
        std::optional<FieldFile> file;
        bool isPreview = false;

        bool operator==(const Key&) const = default;
    };
    struct Made {
        std::shared_ptr<const ColourField> field;
        std::string name; ///< of a second field
    };

    void followDataset();
    void refresh();
    std::optional<Key> wantedKey() const;
    void make();
    std::function<Result<Made>(const JobControl&)> workFor(const Key& key) const;
    void drop();
    void take(Result<Made> made);
    void refuse(const Error& error);
    SurfaceColours drawable() const;

    Session& session_;
    ViewState& view_;
    DatasetGeneration dataset_{};
    std::optional<Key> key_; ///< of what is there or on its way
    std::optional<JobId> making_;
    std::uint64_t ticket_ = 0; ///< distinguishes what is being made from what was, which still reports its end
    Made made_;
    Colouring last_; ///< the last that could be drawn
    SurfaceColours colours_;
    ObserverList<> changed_;
    std::vector<Subscription> subscriptions_;
    std::shared_ptr<bool> isAlive_ = std::make_shared<bool>(true);
    LatestJob<std::optional<ColourRange>> fitting_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
