#pragma once

#include "ui/model/opening/preview_model.h"
#include "ui/model/opening/raw_ranking.h"

namespace isoslider::model {

/// A headerless file while it is stated how its samples are arranged: the ways that suggest themselves, the one
/// chosen, how it fits the file's size, and how it looks. Begins with what name and size state; the best of the
/// ways found takes its place, unless the user has changed something by then. Window thread only.
class RawImportModel {
public:
    enum class Fit {
        NoVolume, ///< an axis has fewer than 2 grid points
        Exact,
        FileLonger, ///< bytes are left over
        FileShorter
    };

    RawImportModel(std::filesystem::path path, std::uint64_t fileBytes, std::shared_ptr<BackgroundJobs> jobs,
                   VolumeAccess volumes);

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t fileBytes() const { return fileBytes_; }
    const io::RawLayout& layout() const { return layout_; }
    bool allowsTrailing() const { return allowsTrailing_; }
    /// What opens the file this way.
    io::ReadOptions options() const;

    /// Best first; empty until they are there, and where none fits.
    const std::vector<RawGuess>& guesses() const { return guesses_; }
    bool isRanking() const { return ranking_.isRunning(); }
    /// In guesses(); none if the layout is another.
    std::optional<std::size_t> chosenGuess() const;
    void takeGuess(std::size_t index);

    /// REQUIRES: dims within kMaxDim.
    void setLayout(const io::RawLayout& layout);
    void setAllowsTrailing(bool isAllowed);
    void swapByteOrder();

    Fit fit() const;
    std::uint64_t neededBytes() const;
    bool canOpen() const;
    /// Null unless the other byte order looks right.
    const ByteOrderCheck* swapWarning() const { return check_ && check_->looksSwapped() ? &*check_ : nullptr; }
    const PreviewModel& preview() const { return preview_; }

    const Observable<>& changed() const { return changed_; }

private:
    void change(const io::RawLayout& layout);
    void rank();
    void onRanked(Result<std::vector<RawGuess>> guesses);
    void showPreview();

    std::filesystem::path path_;
    std::uint64_t fileBytes_;
    io::RawLayout layout_;
    bool allowsTrailing_ = false;
    bool isTouched_ = false; ///< the user has chosen or typed something
    std::vector<RawGuess> guesses_;
    std::optional<ByteOrderCheck> check_;
    ObserverList<> changed_;
    PreviewModel preview_;
    Subscription previewSubscription_;
    LatestJob<ByteOrderCheck> checking_;
    LatestJob<std::vector<RawGuess>> ranking_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
