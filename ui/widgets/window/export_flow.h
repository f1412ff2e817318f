#pragma once

#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "ui/model/observers.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/shown_surfaces.h"

class QWidget;

namespace isoslider::model {
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class FileDialogs;
class SettingsStore;

/// Asks where to write meshes: of the whole surface, of what is shown, of the selected piece, of the crop box.
/// Everything it is given must outlive it; `window` is the dialogs' parent.
class ExportFlow : public QObject {
    Q_OBJECT
public:
    struct Parts {
        const ActionRegistry& actions;
        SettingsStore& settings;
        FileDialogs& dialogs;
        model::ViewState& viewState;
    };
    ExportFlow(model::Session& session, const Parts& parts, QWidget* window);

private:
    /// What of a surface is shown.
    struct ShownPart {
        model::SurfaceId surface{};
        QString name;
        model::Session::ExportPart part;
    };

    void askWhole();
    /// Of the active surface, as a remark on an export of the whole.
    QString whatIsNotShown() const;
    void askShown();
    void askSelected();
    void askClosed();
    void ask(const QString& title, const QString& addition, const model::Session::ExportPart& part);
    QString suggestedPath(const QString& addition) const;
    void rememberFolder(const QString& path);
    void exportAll(const std::vector<ShownPart>& parts, const QString& path, model::DatasetGeneration of);
    /// None without pieces that are known.
    std::optional<model::Session::ExportPart::Pieces> selectedPiece() const;
    static std::optional<model::Session::ExportPart::Pieces> shownPiecesOf(const model::ShownSurface& surface);
    void showWhatIsPossible();

    model::Session& session_;
    Parts parts_;
    QWidget* window_;
    model::Subscription frameSubscription_;
    model::Subscription surfacesSubscription_;
    model::Subscription optionsSubscription_;
};

} // namespace isoslider::widgets
