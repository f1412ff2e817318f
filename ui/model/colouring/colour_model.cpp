#include "ui/model/colouring/colour_model.h"

#include <algorithm>
#include <utility>

#include "core/base/folders.h"
#include "core/extract/slices/slice_sampler.h"
#include "ui/model/colouring/surface_range.h"
#include "ui/model/slices/slice_source.h"

namespace isoslider::model {
namespace {

bool needsField(ColourBy by) { return by == ColourBy::Gradient || by == ColourBy::Field; }

ReadPlane planesOfIndex(std::shared_ptr<extract::SliceSampler> sampler, const JobControl& job) {
    return [sampler = std::move(sampler), &job](std::int64_t z, std::span<float> plane) -> Status {
        const GridDims& dims = sampler->geometry().dims;
        extract::SlicePlane pixels;
        pixels.origin.z = static_cast<double>(z);
        pixels.width = static_cast<int>(dims[0]);
        pixels.height = static_cast<int>(dims[1]);
        const auto samples = sampler->sample(pixels, {job.stop, {}});
        if (!samples.isOk())
            return samples.error();
        std::copy(samples.value().values.begin(), samples.value().values.end(), plane.begin());
        return {};
    };
}

Result<std::shared_ptr<const ColourField>> shared(Result<ColourField> field, std::int64_t gridStep = 1) {
    if (!field.isOk())
        return std::move(field).error();
    field.value().gridStep = gridStep;
    return std::make_shared<const ColourField>(std::move(field).value());
}

/// A second field: what is not of the volume's grid is refused before it is read.
Result<std::pair<std::shared_ptr<const ColourField>, std::string>> readField(const FieldFile& file,
                                                                             const Dataset& dataset,
                                                                             const VolumeAccess& volumes,
                                                                             const JobControl& job) {
    auto opened = volumes.open(file.path, file.options);
    if (!opened.isOk())
        return opened.error();
    const std::shared_ptr<io::VolumeSource> source = std::move(opened).value();
    const std::string different = latticeDifference(source->info().geometry, dataset.geometry, !file.options.raw);
    if (!different.empty())
        return makeError(ErrorCode::InvalidArgument, "does not lie on the grid of " + dataset.name + ": " + different,
                         file.path.filename().string());
    const JobControl preparing = job.part(0.0, 0.3), reading = job.part(0.3, 1.0);
    ISO_TRY(source->prepare(preparing));
    auto field = shared(makeColourField(dataset.geometry, planesOf(source), false, reading));
    if (!field.isOk())
        return std::move(field).error();
    ISO_TRY(source->checkUnchanged());
    const io::VolumeInfo& info = source->info();
    return std::pair(std::move(field).value(), !info.fieldTitle.empty()  ? info.fieldTitle
                                               : !info.fieldName.empty() ? info.fieldName
                                                                         : file.path.filename().string());
}

} // namespace

ColourModel::ColourModel(Session& session, ViewState& view)
    : session_(session), view_(view), fitting_(std::make_shared<BackgroundJobs>(session.services().postToMain)) {
    subscriptions_.push_back(view_.observe([this] { refresh(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { followDataset(); }));
    followDataset();
}

// Ranges and fields are of one volume.
void ColourModel::followDataset() {
    if (std::exchange(dataset_, session_.datasetGeneration()) != session_.datasetGeneration()) {
        fitting_.cancel();
        change([](Colouring& colouring) {
            Colouring fresh;
            fresh.map = colouring.map;
            fresh.isReversed = colouring.isReversed;
            colouring = fresh;
        });
    }
    refresh();
}

void ColourModel::change(const std::function<void(Colouring&)>& change) {
    auto options = view_.options();
    change(options.colouring);
    view_.setOptions(options);
}

void ColourModel::choose(ColourBy by, const std::optional<FieldFile>& field) {
    auto options = view_.options();
    Colouring& colouring = options.colouring;
    if (by != colouring.by || field != colouring.field)
        colouring.range.reset(); // of other values
    colouring.by = by;
    colouring.field = field;
    options.pieces.isColoured = false; // which would hide it
    if (field)
        drop(); // the file may have been written again
    view_.setOptions(options);
    refresh();
}

std::optional<ColourModel::Key> ColourModel::wantedKey() const {
    const auto* dataset = session_.dataset();
    const Colouring& colouring = wanted();
    if (dataset == nullptr || !needsField(colouring.by))
        return std::nullopt;
    const bool isPreview = colouring.by == ColourBy::Gradient && session_.samples() && dataset->coarseStep > 1;
    return Key{dataset_, colouring.by, colouring.by == ColourBy::Field ? colouring.field : std::nullopt, isPreview};
}

void ColourModel::refresh() {
    if (auto key = wantedKey(); key != key_) {
        drop();
        key_ = std::move(key);
        made_ = {};
        if (key_)
            make();
    }
    if (session_.dataset() != nullptr && (!needsField(wanted().by) || made_.field))
        last_ = wanted();
    colours_ = drawable();
    changed_.notify();
}

/// What is being made, or is there, is not wanted any more.
void ColourModel::drop() {
    if (making_)
        session_.cancelJob(*std::exchange(making_, std::nullopt));
    ++ticket_;
    key_.reset();
}

void ColourModel::make() {
    making_ = session_.runner().run<Made>(
        key_->by == ColourBy::Gradient ? "Gradient for colours" : "Second field for colours", workFor(*key_),
        [this, alive = std::weak_ptr<bool>(isAlive_), ticket = ticket_](Result<Made> made) {
            if (alive.lock() && ticket == ticket_) // otherwise something else is wanted by now
                take(std::move(made));
        });
}

std::function<Result<ColourModel::Made>(const JobControl&)> ColourModel::workFor(const Key& key) const {
    using Field = std::shared_ptr<const ColourField>;
    if (key.by == ColourBy::Field)
        return [file = key.file.value_or(FieldFile{}), dataset = *session_.dataset(),
                volumes = session_.services().volumes](const JobControl& job) -> Result<Made> {
            auto field = readField(file, dataset, volumes, job);
            if (!field.isOk())
                return std::move(field).error();
            return Made{field.value().first, field.value().second};
        };
    return [grid = session_.samples(), dataset = *session_.dataset()](const JobControl& job) -> Result<Made> {
        Result<Field> field = cancelledError();
        if (grid) {
            field = shared(makeColourField(grid->geometry(), planesOf(grid), true, job), dataset.coarseStep);
        } else {
            auto sampler = openSamples(dataset);
            if (!sampler.isOk())
                return sampler.error();
            field =
                shared(makeColourField(dataset.geometry, planesOfIndex(std::move(sampler).value(), job), true, job));
        }
        if (!field.isOk())
            return std::move(field).error();
        return Made{std::move(field).value(), {}};
    };
}

void ColourModel::take(Result<Made> made) {
    making_.reset();
    if (!made.isOk())
        return refuse(made.error());
    made_ = std::move(made).value();
    refresh();
}

void ColourModel::refuse(const Error& error) {
    if (error.code != ErrorCode::Cancelled)
        session_.post({Notice::Severity::Error,
                       key_->by == ColourBy::Field ? "The surface cannot be coloured by the second field"
                                                   : "The surface cannot be coloured by gradient",
                       error.line(), error.code});
    key_.reset();
    const bool isTriedAgain = last_.by == wanted().by && last_.field == wanted().field;
    change([&](Colouring& colouring) {
        colouring.by = isTriedAgain ? ColourBy::One : last_.by;
        colouring.field = isTriedAgain ? std::nullopt : last_.field;
        colouring.range = isTriedAgain ? std::nullopt : last_.range;
    });
}

SurfaceColours ColourModel::drawable() const {
    const auto* dataset = session_.dataset();
    const Colouring& colouring = wanted();
    SurfaceColours colours;
    if (dataset == nullptr || colouring.by == ColourBy::One || (needsField(colouring.by) && !made_.field))
        return colours;
    colours.by = colouring.by;
    colours.field = made_.field;
    colours.map = colouring.map;
    colours.isReversed = colouring.isReversed;
    colours.range = colouring.range ? *colouring.range
                    : made_.field   ? usableRange(made_.field->usual)
                                    : rangeOfVolume(colouring.by, dataset->geometry);
    return colours;
}

std::string ColourModel::title() const {
    switch (colours_.by) {
        case ColourBy::One: break;
        case ColourBy::Gradient: return "Gradient magnitude";
        case ColourBy::X: return "X";
        case ColourBy::Y: return "Y";
        case ColourBy::Z: return "Z";
        case ColourBy::Middle: return "Distance from middle";
        case ColourBy::Field: return made_.name;
    }
    return {};
}

std::string ColourModel::unit() const {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr || colours_.by == ColourBy::Field)
        return {};
    const std::string& length = dataset->lengthUnit;
    if (colours_.by == ColourBy::Gradient)
        return "per " + (length.empty() ? std::string("unit of length") : length);
    return length;
}

std::string ColourModel::note() const {
    if (!made_.field)
        return {};
    const std::int64_t step = made_.field->step * made_.field->gridStep;
    return step > 1 ? "Shown at 1/" + std::to_string(step) + " of the resolution" : std::string();
}

void ColourModel::fitToSurface() {
    const auto frame = session_.frame();
    const auto* dataset = session_.dataset();
    if (!frame || dataset == nullptr || colours_.by == ColourBy::One)
        return;
    fitting_.start(
        "Range on the surface",
        [frame, colours = colours_, volume = dataset->geometry,
         cuts = cutsOf(view_.options().clipping, frame->geometry, dataset->geometry)](const JobControl& job) {
            return rangeOnSurface(*frame, colours, volume, cuts, job);
        },
        [this, by = colours_.by, field = colours_.field](const Result<std::optional<ColourRange>>& range) {
            if (range.isOk() && range.value() && by == colours_.by && field == colours_.field)
                change([&](Colouring& colouring) { colouring.range = *range.value(); });
        });
}

} // namespace isoslider::model
