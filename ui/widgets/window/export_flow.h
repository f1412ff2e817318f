#pragma once

#include <optional>

#include <QObject>
#include <QString>

#include "ui/model/observers.h"
#include "ui/model/session/session.h"

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
    enum class Choice { Shown, Selected };

    void askWhole();
    void askShown();
    void askSelected();
    void askClosed();
    void ask(const QString& title, const QString& addition, const model::Session::ExportPart& part);
    QString suggestedPath(const QString& addition) const;
    void rememberFolder(const QString& path);
    /// None without pieces that are known.
    std::optional<model::Session::ExportPart::Pieces> piecesOf(Choice choice) const;
    void showWhatIsPossible();

    model::Session& session_;
    Parts parts_;
    QWidget* window_;
    model::Subscription frameSubscription_;
    model::Subscription optionsSubscription_;
};

} // namespace isoslider::widgets
