#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/pieces/piece_persistence.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

class Session;

/// Finds, in the background, which pieces of the first volume's surfaces last less than each surface asks for, once
/// its picture rests and has pieces. Window thread only.
class ShortLivedSearch {
public:
    using Found = std::function<void(SurfaceId, std::shared_ptr<const ShortLivedPieces>)>;

    /// `found` puts an answer into the options of that surface; told of what cannot be found, too.
    ShortLivedSearch(Session& session, Found found);

    /// To be called when pictures, surfaces or options have changed: asks what is not known, one surface at a time.
    void update();

private:
    struct Question {
        SurfaceId surface{};
        double isovalue = 0.0, leastPersistence = 0.0;
        GridDims dims{}; ///< of the picture's grid

        bool operator==(const Question&) const = default;
    };
    std::optional<Question> nextQuestion() const;
    void ask(const Question& question);

    Session& session_;
    Found found_;
    std::shared_ptr<PersistenceFinder> finder_; ///< shared with the job; its samples are kept while somebody asks
    std::optional<Question> asked_;
    LatestJob<ShortLivedPieces> job_;
};

} // namespace isoslider::model
