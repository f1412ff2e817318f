#include "ui/model/pieces/short_lived_search.h"

#include <algorithm>
#include <utility>

#include "ui/model/session/session.h"

namespace isoslider::model {

ShortLivedSearch::ShortLivedSearch(Session& session, Found found)
    : session_(session),
      found_(std::move(found)),
      job_(std::make_shared<BackgroundJobs>(session.services().postToMain)) {}

void ShortLivedSearch::update() {
    const auto& surfaces = session_.surfaces().list().surfaces;
    if (std::ranges::none_of(surfaces, [](const auto& each) { return each.hiddenPieces.leastPersistence > 0.0; })) {
        asked_.reset();
        job_.cancel();
        finder_.reset();
        return;
    }
    const auto question = nextQuestion();
    if (!question || question == asked_)
        return; // what was asked before is answered: numbers of pieces last from picture to picture
    ask(*question);
}

std::optional<ShortLivedSearch::Question> ShortLivedSearch::nextQuestion() const {
    const SurfaceList& list = session_.surfaces().list();
    for (const ListedSurface& surface : list.surfaces) {
        const HiddenPieces& hidden = surface.hiddenPieces;
        const bool isActive = surface.id == list.active;
        const auto picture = isActive ? session_.frame() : session_.pictureOf(surface.id);
        if (!(hidden.leastPersistence > 0.0) || !picture || !picture->pieces || picture->isovalue != surface.isovalue ||
            (isActive && session_.isMoving()))
            continue;
        const Question question{surface.id, picture->isovalue, hidden.leastPersistence, picture->geometry.dims};
        const ShortLivedPieces* known = hidden.shortLived.get();
        if (known == nullptr || known->isovalue != question.isovalue ||
            known->leastPersistence != question.leastPersistence || known->dims != question.dims)
            return question;
    }
    return std::nullopt;
}

void ShortLivedSearch::ask(const Question& question) {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    if (!finder_)
        finder_ = std::make_shared<PersistenceFinder>();
    asked_ = question;
    const bool isActive = question.surface == session_.surfaces().list().active;
    job_.start(
        "Find pieces that last shortly",
        [frame = isActive ? session_.frame() : session_.pictureOf(question.surface), dataset = *dataset,
         grid = session_.samples(), finder = finder_, least = question.leastPersistence](const JobControl& job) {
            return finder->findShortLived(*frame, least, dataset, grid, job);
        },
        [this, question](const Result<ShortLivedPieces>& result) {
            asked_.reset();
            ShortLivedPieces pieces{question.isovalue, question.dims, question.leastPersistence, {}, false, {}};
            if (result.isOk())
                pieces = result.value();
            else
                pieces.error = result.error().message;
            found_(question.surface, std::make_shared<const ShortLivedPieces>(std::move(pieces)));
            update();
        });
}

} // namespace isoslider::model
