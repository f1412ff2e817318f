#include "ui/model/opening/raw_import_model.h"

#include <algorithm>

#include "ui/model/opening/raw_guess.h"

namespace isoslider::model {
namespace {

/// Whatever the spacing, which no byte of the file reports.
bool isSameReading(const io::RawLayout& a, const io::RawLayout& b) {
    return a.dims == b.dims && a.type == b.type && a.skipBytes == b.skipBytes &&
           (a.isBigEndian == b.isBigEndian || scalarTypeSizeBytes(a.type) == 1);
}

} // namespace

RawImportModel::RawImportModel(std::filesystem::path path, std::uint64_t fileBytes,
                               std::shared_ptr<BackgroundJobs> jobs, VolumeAccess volumes)
    : path_(std::move(path)),
      fileBytes_(fileBytes),
      layout_(guessRawLayout(path_.filename().string(), fileBytes)),
      preview_(jobs, std::move(volumes)),
      checking_(jobs),
      ranking_(jobs) {
    for (auto& dim : layout_.dims)
        dim = std::clamp<std::int64_t>(dim, 0, kMaxDim);
    previewSubscription_ = preview_.changed().observe([this] { changed_.notify(); });
    rank();
    showPreview();
}

void RawImportModel::rank() {
    ranking_.start(
        "Examine " + path_.filename().string(),
        [file = path_](const JobControl& job) { return rankRawLayouts(file, job); },
        [this](Result<std::vector<RawGuess>> guesses) { onRanked(std::move(guesses)); });
}

void RawImportModel::onRanked(Result<std::vector<RawGuess>> guesses) {
    if (guesses.isOk()) // otherwise the preview reports what is wrong with the file
        guesses_ = std::move(guesses).value();
    if (!isTouched_ && !guesses_.empty())
        change(guesses_.front().layout);
    changed_.notify();
}

io::ReadOptions RawImportModel::options() const {
    io::ReadOptions options;
    options.raw = layout_;
    options.allowsTrailing = allowsTrailing_;
    return options;
}

std::optional<std::size_t> RawImportModel::chosenGuess() const {
    const auto found = std::find_if(guesses_.begin(), guesses_.end(),
                                    [this](const RawGuess& guess) { return isSameReading(guess.layout, layout_); });
    return found == guesses_.end() ? std::nullopt : std::optional<std::size_t>(found - guesses_.begin());
}

void RawImportModel::takeGuess(std::size_t index) {
    if (index >= guesses_.size())
        return;
    isTouched_ = true;
    io::RawLayout layout = guesses_[index].layout;
    layout.spacing = layout_.spacing;
    change(layout);
}

void RawImportModel::setLayout(const io::RawLayout& layout) {
    if (layout == layout_)
        return;
    isTouched_ = true;
    change(layout);
}

void RawImportModel::setAllowsTrailing(bool isAllowed) {
    allowsTrailing_ = isAllowed;
    changed_.notify();
}

void RawImportModel::swapByteOrder() {
    io::RawLayout layout = layout_;
    layout.isBigEndian = !layout.isBigEndian;
    setLayout(layout);
}

void RawImportModel::change(const io::RawLayout& layout) {
    const bool isOtherReading = !isSameReading(layout, layout_) || layout.spacing != layout_.spacing;
    layout_ = layout;
    if (isOtherReading)
        showPreview();
    changed_.notify();
}

RawImportModel::Fit RawImportModel::fit() const {
    if (std::any_of(layout_.dims.begin(), layout_.dims.end(), [](std::int64_t n) { return n < 2; }))
        return Fit::NoVolume;
    const auto needed = neededBytes();
    return needed == fileBytes_ ? Fit::Exact : needed < fileBytes_ ? Fit::FileLonger : Fit::FileShorter;
}

std::uint64_t RawImportModel::neededBytes() const { return layoutBytes(layout_); }

bool RawImportModel::canOpen() const { return fit() == Fit::Exact || (fit() == Fit::FileLonger && allowsTrailing_); }

void RawImportModel::showPreview() {
    check_.reset();
    if (fit() == Fit::NoVolume || fit() == Fit::FileShorter) {
        checking_.cancel();
        return preview_.clear();
    }
    io::ReadOptions options = this->options();
    options.allowsTrailing = true; // to be seen while the size is still being found
    preview_.show(path_, options);
    checking_.start(
        "Check byte order",
        [file = path_, layout = layout_](const JobControl&) { return checkByteOrder(file, layout); },
        [this](Result<ByteOrderCheck> check) {
            if (check.isOk())
                check_ = check.value();
            changed_.notify();
        });
}

} // namespace isoslider::model
