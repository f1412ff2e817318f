#include "ui/model/slices/cap_model.h"

#include <utility>

#include "ui/model/slices/slice_geometry.h"

namespace isoslider::model {
namespace {

/// All that samples depend on.
bool isSamePlane(const ClipPlane& a, const ClipPlane& b) { return a.normal == b.normal && a.offset == b.offset; }

} // namespace

CapModel::CapModel(Session& session, const ViewState& view, std::size_t place)
    : session_(session),
      view_(view),
      place_(place),
      jobs_(std::make_shared<BackgroundJobs>(session.services().postToMain)) {}

ValueWindow CapModel::window() const {
    const auto* dataset = session_.dataset();
    return dataset != nullptr && dataset->values ? automaticWindow(*dataset->values) : ValueWindow{};
}

bool CapModel::isWanted() const { return session_.dataset() != nullptr && plane().isOn && plane().cap != Cap::None; }

bool CapModel::isSettled() const {
    if (!isWanted())
        return true;
    return !isOpening_ && !isSampling_ &&
           ((samples_ && isSamePlane(samples_->of, plane())) || failed_ || !problem_.empty());
}

void CapModel::setProblem(std::string problem) {
    if (std::exchange(problem_, problem) != problem)
        changed_.notify();
}

void CapModel::forget() {
    source_.reset();
    sampled_.reset();
    sampler_.reset();
    failed_.reset();
    setProblem({});
    if (std::exchange(samples_, nullptr))
        changed_.notify();
}

void CapModel::refresh() {
    if (!isWanted())
        return forget();
    chooseSource();
    sample();
}

void CapModel::chooseSource() {
    if (source_ && source_->dataset != session_.datasetGeneration())
        forget();
    const auto grid = session_.samples();
    const Source source{session_.datasetGeneration(), grid != nullptr, grid ? session_.dataset()->coarseStep : 1};
    if (source_ == source)
        return;
    source_ = source;
    sampler_.reset();
    failed_.reset();
    setProblem({});
    if (grid)
        sampler_ = extract::makeSliceSampler(grid);
    else if (session_.indexState() == IndexState::Ready && !isOpening_)
        openSource();
}

void CapModel::openSource() {
    isOpening_ = true;
    jobs_->runner().run<std::shared_ptr<extract::SliceSampler>>(
        "Open samples", [dataset = *session_.dataset()](const JobControl&) { return openSamples(dataset); },
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
        });
}

void CapModel::sample() {
    const ClipPlane plane = this->plane();
    if (isSampling_ || !sampler_ || (failed_ && isSamePlane(*failed_, plane)) ||
        (samples_ && sampled_ == source_ && isSamePlane(samples_->of, plane)))
        return;
    isSampling_ = true;
    using Samples = std::shared_ptr<const CapSamples>;
    jobs_->runner().run<Samples>(
        "Cap",
        [sampler = sampler_, plane, step = source_->step,
         volume = session_.dataset()->geometry](const JobControl& job) -> Result<Samples> {
            const auto pixels = capPlaneOf(plane, volume, step);
            const auto samples = sampler->sample(step > 1 ? pixels.onEvery(static_cast<double>(step)) : pixels, job);
            if (!samples.isOk())
                return samples.error();
            return std::make_shared<const CapSamples>(capSamplesOf(plane, pixels, samples.value(), volume.dims));
        },
        [this, plane, source = *source_](Result<Samples> samples) {
            isSampling_ = false;
            if (isWanted() && source.dataset == session_.datasetGeneration()) {
                if (samples.isOk()) {
                    samples_ = std::move(samples).value();
                    sampled_ = source;
                    failed_.reset();
                    setProblem({});
                } else if (!samples.isCancelled()) {
                    failed_ = plane;
                    setProblem(samples.error().line());
                }
                changed_.notify();
            }
            refresh();
        });
}

} // namespace isoslider::model
