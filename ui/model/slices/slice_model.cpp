#include "ui/model/slices/slice_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "ui/model/session/session.h"
#include "ui/model/slices/slice_source.h"

namespace isoslider::model {
namespace {

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::dvec3 middleOf(const Dataset& dataset) {
    const GridDims& dims = dataset.geometry.dims;
    return snappedPlace(0.5 * (glm::dvec3(dims[0], dims[1], dims[2]) - 1.0), dataset.geometry);
}

/// Without a place that is one, the slices meet in the middle.
SliceOptions within(SliceOptions options, const Dataset* dataset) {
    if (!isFinite(options.position))
        options.position = dataset != nullptr ? middleOf(*dataset) : glm::dvec3(0.0);
    if (dataset != nullptr)
        options.position = clampedPlace(options.position, dataset->geometry);
    for (PaneView& view : options.views) {
        view.zoom = std::isfinite(view.zoom) ? std::clamp(view.zoom, kLeastPaneZoom, kMostPaneZoom) : 1.0;
        for (int axis = 0; axis < 2; ++axis)
            view.middle[axis] = std::isfinite(view.middle[axis]) ? std::clamp(view.middle[axis], 0.0, 1.0) : 0.5;
    }
    const double length = glm::length(options.orientation);
    if (!(std::isfinite(length) && length > 1e-6))
        options.orientation = glm::dquat(1.0, 0.0, 0.0, 0.0);
    else if (std::abs(length - 1.0) > 1e-12) // not again and again: equal options must stay equal
        options.orientation = options.orientation / length;
    if (options.window && !(std::isfinite(options.window->low) && std::isfinite(options.window->high) &&
                            std::isfinite(options.window->width()) && options.window->width() > 0.0))
        options.window.reset();
    return options;
}

/// A preview may end before the volume does.
extract::SlicePlane onPreview(SliceKind kind, extract::SlicePlane plane, const GridGeometry& grid, std::int64_t step) {
    plane = plane.onEvery(static_cast<double>(step));
    if (kind != SliceKind::Oblique) {
        const int axis = gridAxisOf(kind, grid);
        const auto last = static_cast<double>(grid.dims[static_cast<std::size_t>(axis)] - 1);
        plane.origin[axis] = std::min(plane.origin[axis], last);
    }
    return plane;
}

} // namespace

SliceModel::SliceModel(Session& session)
    : session_(session), jobs_(std::make_shared<BackgroundJobs>(session.services().postToMain)) {
    datasetSubscription_ = session_.datasetChanged().observe([this] { followDataset(); });
    frameSubscription_ = session_.frameChanged().observe([this] { noteSurfaces(); });
    surfacesSubscription_ = session_.surfaces().observe([this] { noteSurfaces(); });
    inactiveSubscription_ = session_.inactiveChanged().observe([this] { noteSurfaces(); });
    followDataset();
}

SliceModel::~SliceModel() = default;

const Dataset* SliceModel::dataset() const { return session_.dataset(); }

void SliceModel::followDataset() {
    if (std::exchange(dataset_, session_.datasetGeneration()) != session_.datasetGeneration()) {
        slices_ = {};
        source_.reset();
        sampler_.reset();
        setProblem({});
        SliceOptions options = options_;
        options.window.reset(); // of other values
        options.views = {};
        if (dataset() != nullptr)
            options.position = middleOf(*dataset());
        options_ = within(options, dataset());
        changed_.notify();
        pictures_.notify();
    }
    refresh();
}

void SliceModel::setOptions(const SliceOptions& options) {
    const SliceOptions wanted = within(options, dataset());
    if (wanted == options_)
        return;
    options_ = wanted;
    changed_.notify();
    refresh();
}

void SliceModel::change(const std::function<void(SliceOptions&)>& change) {
    SliceOptions options = options_;
    change(options);
    setOptions(options);
}

void SliceModel::step(SliceKind kind, double steps) {
    if (dataset() != nullptr)
        moveTo(steppedPlace(kind, steps, options_, dataset()->geometry), false);
}

void SliceModel::moveTo(const glm::dvec3& place, bool snaps) {
    if (dataset() == nullptr)
        return;
    change([&](SliceOptions& options) { options.position = snaps ? snappedPlace(place, dataset()->geometry) : place; });
}

void SliceModel::resetPosition() {
    if (dataset() == nullptr)
        return;
    moveTo(middleOf(*dataset()));
}

bool SliceModel::isInPane(SliceKind kind) const {
    switch (options_.layout) {
        case SliceLayout::None: return false;
        case SliceLayout::One: return options_.onePane == kind;
        case SliceLayout::Three:
        case SliceLayout::Four: return kind != SliceKind::Oblique;
    }
    return false;
}

ValueWindow SliceModel::window() const {
    if (options_.window)
        return *options_.window;
    return dataset() != nullptr && dataset()->values ? automaticWindow(*dataset()->values) : ValueWindow{};
}

extract::SlicePlane SliceModel::planeOf(SliceKind kind) const {
    return model::planeOf(kind, options_, dataset()->geometry, source_ ? source_->step : 1);
}

bool SliceModel::isPatient() const { return dataset() != nullptr && isPatientSpace(*dataset()); }

SliceLabels SliceModel::labels(SliceKind kind) const {
    return dataset() != nullptr ? sliceLabels(kind, options_, dataset()->geometry, isPatient()) : SliceLabels{};
}

std::shared_ptr<const SliceShades> SliceModel::shades(SliceKind kind) {
    Slice& slice = slices_[placeOf(kind)];
    if (!slice.samples || dataset() == nullptr)
        return nullptr;
    if (!slice.shades || slice.shadesWindow != window()) {
        slice.shadesWindow = window();
        slice.shades = std::make_shared<SliceShades>(
            shadesOf(*slice.samples, slice.samples->plane, slice.shadesWindow, dataset()->geometry.dims));
    }
    return slice.shades;
}

std::shared_ptr<const SliceContour> SliceModel::contour(SliceKind kind) const {
    return options_.showsContour ? slices_[placeOf(kind)].contour : nullptr;
}

std::optional<SliceReading> SliceModel::reading(SliceKind kind, double column, double row) const {
    const auto& samples = slices_[placeOf(kind)].samples;
    if (!samples || dataset() == nullptr)
        return std::nullopt;
    const extract::SlicePlane& plane = samples->plane;
    column = std::round(column);
    row = std::round(row);
    if (!(column >= 0.0 && row >= 0.0 && column < plane.width && row < plane.height))
        return std::nullopt;
    SliceReading reading;
    reading.place = plane.at(column, row);
    const glm::dvec3 clamped = clampedPlace(reading.place, dataset()->geometry);
    if (glm::distance(clamped, reading.place) > 1e-6)
        return std::nullopt;
    reading.world = glm::dvec3(dataset()->geometry.indexToWorld() * glm::dvec4(reading.place, 1.0));
    const float value = samples->values[static_cast<std::size_t>(row) * static_cast<std::size_t>(plane.width) +
                                        static_cast<std::size_t>(column)];
    if (!std::isnan(value))
        reading.value = value;
    return reading;
}

bool SliceModel::isSettled() const {
    return !isOpening_ && !isSampling_ && !isCutting_ &&
           std::none_of(kSliceKinds.begin(), kSliceKinds.end(),
                        [this](SliceKind kind) { return (sampler_ && needsSamples(kind)) || needsContour(kind); });
}

std::string SliceModel::problem(SliceKind kind) const {
    const Slice& slice = slices_[placeOf(kind)];
    return slice.failed && dataset() != nullptr && *slice.failed == planeOf(kind) ? slice.problem : problem_;
}

void SliceModel::setProblem(std::string problem) {
    if (problem == problem_)
        return;
    problem_ = std::move(problem);
    pictures_.notify();
}

void SliceModel::refresh() {
    chooseSource();
    sampleNext();
    cutNext();
}

// Nothing is kept of a volume for slices that nobody looks at.
void SliceModel::chooseSource() {
    const bool isWanted = dataset() != nullptr && std::any_of(kSliceKinds.begin(), kSliceKinds.end(),
                                                              [this](SliceKind kind) { return isShown(kind); });
    if (!isWanted) {
        source_.reset();
        sampler_.reset();
        return;
    }
    const auto grid = session_.samples();
    const Source source{dataset_, grid != nullptr, grid ? dataset()->coarseStep : 1};
    if (source_ == source)
        return;
    source_ = source;
    sampler_.reset();
    setProblem({});
    if (grid)
        sampler_ = extract::makeSliceSampler(grid);
    else if (session_.indexState() == IndexState::Ready && !isOpening_)
        openSource();
}

void SliceModel::openSource() {
    isOpening_ = true;
    jobs_->runner().run<std::shared_ptr<extract::SliceSampler>>(
        "Open samples", [dataset = *dataset()](const JobControl&) { return openSamples(dataset); },
        [this, source = *source_](Result<std::shared_ptr<extract::SliceSampler>> sampler) {
            isOpening_ = false;
            if (source_ != source) { // another volume meanwhile: its samples were not opened
                source_.reset();
                return refresh();
            }
            if (sampler.isOk())
                sampler_ = std::move(sampler).value();
            else if (!sampler.isCancelled())
                setProblem(sampler.error().line());
            refresh();
            pictures_.notify();
        });
}

bool SliceModel::needsSamples(SliceKind kind) const {
    const Slice& slice = slices_[placeOf(kind)];
    if (!source_ || !isShown(kind))
        return false;
    const auto plane = planeOf(kind);
    return slice.failed != plane &&
           (!slice.samples || slice.samples->plane != plane || slice.source.step != source_->step);
}

void SliceModel::sampleNext() {
    if (isSampling_ || !sampler_)
        return;
    for (std::size_t turn = 1; turn <= kSliceKinds.size(); ++turn) {
        const SliceKind kind = kSliceKinds[(lastSampled_ + turn) % kSliceKinds.size()];
        if (!needsSamples(kind))
            continue;
        lastSampled_ = placeOf(kind);
        isSampling_ = true;
        const auto plane = planeOf(kind);
        using Samples = std::shared_ptr<const extract::SliceSamples>;
        jobs_->runner().run<Samples>(
            "Slice",
            [sampler = sampler_, kind, plane, step = source_->step](const JobControl& job) -> Result<Samples> {
                auto samples =
                    sampler->sample(step > 1 ? onPreview(kind, plane, sampler->geometry(), step) : plane, job);
                if (!samples.isOk())
                    return samples.error();
                samples.value().plane = plane;
                return std::make_shared<const extract::SliceSamples>(std::move(samples).value());
            },
            [this, kind, plane, source = *source_](Result<Samples> samples) {
                isSampling_ = false;
                if (source.dataset == dataset_) {
                    Slice& slice = slices_[placeOf(kind)];
                    if (samples.isOk()) {
                        slice.samples = std::move(samples).value();
                        slice.source = source;
                        slice.shades.reset();
                        slice.failed.reset();
                    } else if (!samples.isCancelled()) {
                        slice.failed = plane;
                        slice.problem = samples.error().line();
                    }
                    pictures_.notify();
                }
                refresh();
            });
        return;
    }
}

bool SliceModel::showsContours() const {
    return options_.showsContour && std::ranges::any_of(kSliceKinds, [this](SliceKind kind) { return isShown(kind); });
}

bool SliceModel::needsContour(SliceKind kind) const {
    const Slice& slice = slices_[placeOf(kind)];
    return dataset() != nullptr && session_.frame() != nullptr && options_.showsContour && isShown(kind) &&
           (slice.contourSurfaces != surfaces_ || slice.contourPlane != planeOf(kind));
}

std::vector<SliceModel::CutSurface> SliceModel::shownSurfaces() const {
    const SurfaceList& list = session_.surfaces().list();
    std::vector<CutSurface> shown;
    const auto add = [&](const ListedSurface& surface) {
        if (auto frame = session_.pictureOf(surface.id); frame && surface.isVisible)
            shown.push_back({std::move(frame), surface.hiddenPieces, surface.colour});
    };
    for (const ListedSurface& surface : list.surfaces)
        if (surface.id != list.active)
            add(surface);
    if (const ListedSurface* active = list.find(list.active))
        add(*active);
    if (list.surfaces.size() == 1 && !shown.empty())
        shown.front().colour = {kContourColour >> 16 & 0xff, kContourColour >> 8 & 0xff, kContourColour & 0xff};
    return shown;
}

void SliceModel::noteSurfaces() {
    auto shown = shownSurfaces(); // these keep their frames, so that no other one has the address
    const bool isSame =
        std::equal(shown.begin(), shown.end(), cut_.begin(), cut_.end(), [](const CutSurface& a, const CutSurface& b) {
            return a.frame == b.frame && a.hidden == b.hidden && a.colour == b.colour;
        });
    if (!isSame) {
        ++surfaces_;
        cut_ = std::move(shown);
    }
    refresh();
}

namespace {

/// Of all surfaces, one after the other.
Result<std::shared_ptr<const SliceContour>> contourOf(const auto& surfaces, const extract::SlicePlane& plane,
                                                      const GridGeometry& volume, const JobControl& job) {
    auto contour = std::make_shared<SliceContour>();
    for (const auto& surface : surfaces) {
        const extract::SurfaceFrame& frame = *surface.frame;
        std::function<bool(std::uint32_t)> isShown;
        const PieceOptions pieces(surface.hidden);
        std::optional<PieceDisplay> display;
        if (frame.pieces && pieces.hidesAny()) {
            display.emplace(*frame.pieces, frame.geometry, pieces);
            isShown = [&display](std::uint32_t piece) { return display->isShown(piece); };
        }
        auto points = extract::cutSurface(frame, cutPlaneOf(plane, volume, frame.geometry), job, isShown);
        if (!points.isOk())
            return std::move(points).error();
        const glm::vec3 step(frame.geometry.spacing / volume.spacing);
        for (const glm::vec3& point : points.value())
            contour->points.push_back(point * step);
        contour->parts.push_back({contour->points.size(), surface.colour});
    }
    return std::shared_ptr<const SliceContour>(std::move(contour));
}

} // namespace

void SliceModel::cutNext() {
    if (isCutting_)
        return;
    for (std::size_t turn = 1; turn <= kSliceKinds.size(); ++turn) {
        const SliceKind kind = kSliceKinds[(lastCut_ + turn) % kSliceKinds.size()];
        if (!needsContour(kind))
            continue;
        lastCut_ = placeOf(kind);
        isCutting_ = true;
        const auto plane = planeOf(kind);
        using Contour = std::shared_ptr<const SliceContour>;
        jobs_->runner().run<Contour>(
            "Contour",
            [surfaces = cut_, plane, volume = dataset()->geometry](const JobControl& job) -> Result<Contour> {
                return contourOf(surfaces, plane, volume, job);
            },
            [this, kind, plane, dataset = dataset_, surfaces = surfaces_](Result<Contour> contour) {
                isCutting_ = false;
                if (dataset == dataset_) {
                    Slice& slice = slices_[placeOf(kind)];
                    slice.contour = contour.isOk() ? std::move(contour).value() : nullptr;
                    slice.contourPlane = plane;
                    slice.contourSurfaces = surfaces;
                    pictures_.notify();
                }
                refresh();
            });
        return;
    }
}

} // namespace isoslider::model
