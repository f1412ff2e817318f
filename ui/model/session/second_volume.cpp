#include "ui/model/session/second_volume.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "ui/model/isovalue/histogram_model.h"
#include "ui/model/surface/clipping.h"

namespace isoslider::model {
namespace {

NamedVolume nameOf(const Dataset& dataset) { return {dataset.path, dataset.sampleName, dataset.readOptions}; }

bool hasColour(const SurfaceList& list, const SurfaceColour& colour) {
    return std::any_of(list.surfaces.begin(), list.surfaces.end(),
                       [&](const ListedSurface& surface) { return surface.colour == colour; });
}

} // namespace

bool liesApart(const GridGeometry& other, const GridGeometry& volume) {
    Clipping whole;
    whole.isCropped = true;
    const auto cuts = cutsOf(whole, other, volume);
    return std::any_of(cuts.begin(), cuts.end(), [&](const glm::dvec4& cut) {
        double most = cut.w;
        for (int axis = 0; axis < 3; ++axis)
            most += std::max(0.0, cut[axis] * static_cast<double>(other.dims[static_cast<std::size_t>(axis)] - 1));
        return most < 0.0;
    });
}

SecondVolume::SecondVolume(JobRunner& runner, const SessionServices& services, const IndexCache& cache,
                           const SurfacesModel& first, std::function<void(const Notice&)> post)
    : runner_(runner),
      services_(services),
      cache_(cache),
      first_(first),
      post_(std::move(post)),
      pictures_(runner, services.postToMain, [this](const ListedSurface& surface, const Error& error) {
          post_({Notice::Severity::Error, "The surface " + surface.name + " could not be extracted", error.line(),
                 error.code});
      }) {
    surfacesSubscription_ = surfaces_.observe([this] { followSurfaces(); });
    picturesSubscription_ = pictures_.changed().observe([this] { changed_.notify(); });
}

void SecondVolume::open(const OpenRequest& request) {
    stopOpening();
    load(request);
    changed_.notify();
}

void SecondVolume::load(const OpenRequest& request) {
    opening_ = displayName(request);
    loadJob_ = runner_.run<OpenedVolume>(
        "Open " + opening_,
        [request, cache = cache_, services = services_](const JobControl& job) {
            return openOrAsk(request, services, cache, job);
        },
        [this, request, ticket = ticket_](Result<OpenedVolume> opened) {
            if (ticket == ticket_)
                onOpened(std::move(opened), request);
        });
}

void SecondVolume::stopOpening() {
    if (loadJob_)
        runner_.cancel(*loadJob_);
    loadJob_.reset();
    opening_.clear();
    ++ticket_;
    if (!dataset_)
        wanted_ = {};
}

void SecondVolume::forget() {
    dataset_.reset();
    pictures_.clear();
    wanted_ = {};
    surfaces_.clear();
}

void SecondVolume::close() {
    if (!loadJob_ && !dataset_ && wanted_.volume.isNone())
        return;
    stopOpening();
    forget();
    changed_.notify();
}

void SecondVolume::setState(const SecondVolumeState& state) {
    if (state.volume.isNone())
        return close();
    if (dataset_ && nameOf(*dataset_) == state.volume) {
        stopOpening();
        surfaces_.setList(state.surfaces);
        return changed_.notify();
    }
    stopOpening();
    forget();
    wanted_ = state;
    OpenRequest request;
    request.path = state.volume.path;
    request.sampleName = state.volume.sampleName;
    request.readOptions = state.volume.readOptions;
    load(request);
    changed_.notify();
}

SecondVolumeState SecondVolume::state() const {
    return dataset_ ? SecondVolumeState{nameOf(*dataset_), surfaces_.list()} : wanted_;
}

void SecondVolume::onOpened(Result<OpenedVolume> opened, const OpenRequest& request) {
    loadJob_.reset();
    const std::string name = std::exchange(opening_, {});
    if (opened.isOk() && opened.value().loaded) {
        adopt(std::move(*opened.value().loaded));
    } else if (opened.isOk()) {
        changed_.notify();
        choiceNeeded_.notify(request, opened.value().contents);
    } else {
        if (!dataset_)
            wanted_ = {};
        changed_.notify();
        if (!opened.isCancelled())
            post_({Notice::Severity::Error, "Could not open " + name, opened.error().line(), opened.error().code});
    }
}

void SecondVolume::adopt(LoadedDataset loaded) {
    const SurfaceList wanted = std::move(wanted_.surfaces);
    forget();
    dataset_ = std::move(loaded.dataset);
    InactiveSurfaces::Making making;
    making.bound = extract::boundOf(error_, dataset_->min, dataset_->max);
    making.pictureLimit = pictureLimit_;
    making.geometry = loaded.grid ? loaded.grid->geometry() : dataset_->geometry;
    making.openSource =
        loaded.grid ? openerOfMemory(loaded.grid, services_.indexBuilder) : openerOfIndex(dataset_->indexPath);
    pictures_.setMaking(std::move(making));
    surfaces_.begin(std::clamp(loaded.first.isovalue, dataset_->min, dataset_->max));
    if (wanted.surfaces.empty())
        surfaces_.change(surfaces_.list().active,
                         [colour = freeColour()](ListedSurface& surface) { surface.colour = colour; });
    else
        surfaces_.setList(wanted);
    changed_.notify();
}

SurfaceColour SecondVolume::freeColour() const {
    const auto unused = std::find_if(kSurfaceColours.begin(), kSurfaceColours.end(), [this](const NamedColour& named) {
        return !hasColour(first_.list(), named.colour);
    });
    return unused != kSurfaceColours.end() ? unused->colour : kSurfaceColours[1].colour;
}

void SecondVolume::addSurface() {
    if (!dataset_)
        return;
    const SuggestedRange range = dataset_->suggestedRange();
    const auto suggested = suggestedIsovalues({}, model::firstIsovalue(*dataset_->values), range);
    const double isovalue = isovalueForAnother(surfaces_.list(), suggested, range.min, range.max);
    surfaces_.add(std::clamp(suggestedAs(isovalue, range), dataset_->min, dataset_->max));
}

void SecondVolume::followSurfaces() {
    if (!dataset_)
        return;
    const SurfaceList listed = surfaces_.list();
    for (const ListedSurface& surface : listed.surfaces) {
        const double isovalue = std::clamp(surface.isovalue, dataset_->min, dataset_->max);
        surfaces_.change(surface.id, [isovalue](ListedSurface& changed) { changed.isovalue = isovalue; });
    }
    SurfaceList pictured = surfaces_.list();
    pictured.active = {}; // none of them slides
    pictures_.follow(pictured);
}

void SecondVolume::limitPicture(std::uint64_t bytes) {
    pictureLimit_ = bytes;
    pictures_.change([bytes](InactiveSurfaces::Making& making) { making.pictureLimit = bytes; });
}

void SecondVolume::mergeWithin(const extract::MergeError& error) {
    error_ = error;
    if (dataset_)
        pictures_.change([bound = extract::boundOf(error, dataset_->min, dataset_->max)](
                             InactiveSurfaces::Making& making) { making.bound = bound; });
}

} // namespace isoslider::model
