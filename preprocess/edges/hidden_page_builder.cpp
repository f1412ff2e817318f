#include "preprocess/edges/hidden_page_builder.h"

namespace isoslider::preprocess {

Status HiddenPageBuilder::addBrick(std::span<const index::HiddenCorner> corners) {
    if (corners.empty())
        return {};
    const bool isTooMany = page_.size() + corners.size() > index::kMaxHiddenPageCorners;
    if (!page_.empty() && (isTooMany || corners.front().brick - page_.front().brick >= index::kMaxHiddenPageBricks))
        ISO_TRY(finish());
    page_.insert(page_.end(), corners.begin(), corners.end());
    return {};
}

Status HiddenPageBuilder::finish() {
    if (page_.empty())
        return {};
    ISO_TRY(writer_.addHiddenPage(index::hiddenPageEntry(page_), index::encodeHiddenPage(page_, type_)));
    page_.clear();
    return {};
}

} // namespace isoslider::preprocess
