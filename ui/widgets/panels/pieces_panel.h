#pragma once

#include <optional>

#include <QWidget>

#include "core/extract/pieces/surface_pieces.h"
#include "ui/model/observers.h"
#include "ui/widgets/common/throttle.h"

class QLabel;
class QSlider;
class QSpinBox;
class QTableView;

namespace isoslider::model {
class Session;
class ViewState;
struct PieceOptions;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class ElidedLabel;
class PieceDetails;
class PieceTable;

/// The surface's pieces: how many, the largest of them, which are shown and in what colours.
class PiecesPanel : public QWidget {
    Q_OBJECT
public:
    PiecesPanel(model::Session& session, model::ViewState& viewState, const ActionRegistry& actions,
                QWidget* parent = nullptr);

    /// Whether the panel is in sight: a dock behind another one's tab counts as visible to Qt.
    void setSeen(bool isSeen);

Q_SIGNALS:
    void piecePicked(std::optional<isoslider::extract::PieceId> piece);

private:
    void addControls(const ActionRegistry& actions);
    void makeTable(const ActionRegistry& actions);
    void selectRow();
    void showPieces();
    double largestSize() const;
    double rangeOfScalars() const;
    void showPersistence(const model::PieceOptions& options);

    model::Session& session_;
    model::ViewState& viewState_;
    QSlider* size_;
    QSpinBox* largest_;
    QLabel* sizeValue_;
    QSlider* persistence_;
    QLabel* persistenceValue_;
    ElidedLabel* count_;
    PieceTable* table_;
    QTableView* view_;
    PieceDetails* details_;
    bool isSeen_ = false;
    bool isShowing_ = false;
    Throttle throttle_;
    model::Subscription frameSubscription_;
    model::Subscription optionsSubscription_;
};

} // namespace isoslider::widgets
