#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include <QObject>
#include <QPointF>

#include <glm/vec3.hpp>

#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/observers.h"
#include "ui/model/pieces/short_lived_search.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/surface_list.h"

class QDockWidget;

namespace isoslider::model {
class Session;
struct PieceOptions;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class PiecesPanel;
class ViewNote;
class ViewportHost;

/// Picks pieces of the surface in the view and in the list, and hides them: the actions, the view's context menu.
/// Everything it is given must outlive it.
class PieceWiring : public QObject {
    Q_OBJECT
public:
    struct Parts {
        QDockWidget& dock;
        PiecesPanel& panel;
    };
    PieceWiring(model::Session& session, const ActionRegistry& actions, ViewportHost& host, const Parts& parts,
                QObject* parent);

private:
    enum class Purpose { Select, Menu };
    /// What was pointed at in the view, until there is a picture with pieces. The line of sight is that of the click:
    /// the camera may move on.
    struct Pick {
        QPointF point;
        Purpose purpose = Purpose::Select;
        std::pair<glm::dvec3, glm::dvec3> line;
        double isovalue = 0.0;
        bool isComing = false; ///< the surface has just become active
    };

    void connectActions();
    /// Than the selected one.
    void hideSmaller();
    void change(const std::function<void(model::PieceOptions&)>& change);
    /// Asks for pieces while they are looked at, picked or needed for the picture.
    void ask();
    void pick(QPointF point, Purpose purpose);
    /// Hides what a session says is hidden, as soon as there is a picture with pieces.
    void findAwaited();
    void dropLostSelection();
    /// What a line of sight meets first; nothing counts as the active surface.
    enum class Met { Active, Other, OfSecond };
    /// Makes it the active one of its volume.
    Met activatePicked(const std::pair<glm::dvec3, glm::dvec3>& line, Purpose purpose);
    void takePick();
    void select(std::optional<extract::PieceId> piece);
    void showMenu(QPointF point, bool isOfSecond);
    QString menuTitle(bool isOfSecond) const;
    void showOptions();
    /// The view's options hide the pieces that the active surface hides, and the other way about.
    void followSurfaces();
    void tellSurfaces();
    void findAwaitedOfOthers();
    void takeShortLived(model::SurfaceId surface, std::shared_ptr<const model::ShortLivedPieces> found);
    /// Says why nothing is to be seen where everything is hidden.
    void showWhatIsHidden();
    QString whatIsHidden() const;
    void followDataset();

    model::Session& session_;
    const ActionRegistry& actions_;
    ViewportHost& host_;
    Parts parts_;
    ViewNote* note_; // the view's
    bool isPanelSeen_ = false;
    bool hasHidden_ = false; ///< of this volume, by number; a step back may hide it again
    model::SurfaceId followed_{}; ///< whose pieces the view's options hide
    std::optional<Pick> pick_;
    model::ShortLivedSearch shortLived_;
    model::DatasetGeneration dataset_{};
    model::Subscription frameSubscription_;
    model::Subscription datasetSubscription_;
    model::Subscription optionsSubscription_;
    model::Subscription surfacesSubscription_;
    model::Subscription secondSubscription_;
    model::Subscription inactiveSubscription_;
};

} // namespace isoslider::widgets
