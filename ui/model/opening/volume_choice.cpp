#include "ui/model/opening/volume_choice.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr std::int64_t kPreviewExtent = 64; ///< grid points along the longest axis of a resampled preview
constexpr std::int64_t kLeastExtent = 2;

bool isComplex(const std::vector<std::string>& names) {
    return names.size() == 2 && names[0].starts_with("re") && names[1].starts_with("im");
}

GridDims shrunkTo(const GridDims& dims, std::int64_t longest) {
    const std::int64_t extent = *std::max_element(dims.begin(), dims.end());
    if (extent <= longest)
        return dims;
    GridDims small{};
    std::transform(dims.begin(), dims.end(), small.begin(), [&](std::int64_t n) {
        const double share = static_cast<double>(n) / static_cast<double>(extent);
        return std::max(kLeastExtent, static_cast<std::int64_t>(std::llround(share * static_cast<double>(longest))));
    });
    return small;
}

} // namespace

VolumeChoice::VolumeChoice(io::VolumeContents contents) : contents_(std::move(contents)) {
    ISO_CHECK(!contents_.fields.empty());
    setField(std::min(contents_.preferred, contents_.fields.size() - 1));
}

void VolumeChoice::setField(std::size_t index) {
    field_ = std::min(index, contents_.fields.size() - 1);
    // Of a complex number the modulus shows most; of a vector no component is better than another.
    component_ = isComplex(field().componentNames) ? io::kMagnitude : 0;
    frame_ = 0;
    size_ = field().dims;
}

void VolumeChoice::setComponent(int component) {
    component_ =
        component == io::kMagnitude ? component : std::clamp(component, 0, std::max(0, field().components - 1));
}

void VolumeChoice::setFrame(std::int64_t frame) {
    frame_ = std::clamp<std::int64_t>(frame, 0, std::max<std::int64_t>(0, field().frames - 1));
}

void VolumeChoice::setSize(const GridDims& size) {
    std::transform(size.begin(), size.end(), size_.begin(),
                   [](std::int64_t n) { return std::clamp(n, kLeastExtent, kMaxDim); });
}

std::vector<std::string> VolumeChoice::componentNames() const {
    std::vector<std::string> names = field().componentNames;
    names.resize(static_cast<std::size_t>(std::max(1, field().components)));
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i].empty())
            names[i] = std::to_string(i);
    return names;
}

std::string VolumeChoice::problem() const {
    if (!field().problem.empty())
        return field().problem;
    const auto overflows =
        static_cast<double>(size_[0]) * static_cast<double>(size_[1]) * static_cast<double>(size_[2]) >
        static_cast<double>(kMaxPoints);
    if (hasSize() && overflows)
        return "the size has more than " + groupedText(kMaxPoints) + " grid points";
    return {};
}

io::ReadOptions VolumeChoice::options() const {
    io::ReadOptions options;
    if (hasFields() && !(contents_.isPreferredChosen && field_ == contents_.preferred))
        options.field = field().name;
    if (hasComponents())
        options.component = component_;
    if (hasFrames())
        options.frame = frame_;
    if (hasSize() && size_ != field().dims)
        options.resampleDims = size_;
    return options;
}

io::ReadOptions VolumeChoice::previewOptions() const {
    io::ReadOptions options = this->options();
    if (hasSize())
        options.resampleDims = shrunkTo(field().dims, kPreviewExtent);
    return options;
}

bool isWorthAsking(const io::VolumeContents& contents) {
    return contents.needsChoice() && std::any_of(contents.fields.begin(), contents.fields.end(),
                                                 [](const io::VolumeField& field) { return field.problem.empty(); });
}

} // namespace isoslider::model
