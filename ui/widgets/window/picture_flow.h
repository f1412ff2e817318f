#pragma once

#include <QObject>
#include <QString>

#include "ui/widgets/viewport/picture_choice.h"

class QWidget;

namespace isoslider::model {
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class FileDialogs;
class MessageBar;
class SettingsStore;
class ViewportHost;

/// Asks for size and background of a picture of the view, then for its name, and has it drawn and written by a job
/// while the window goes on. Everything it is given must outlive it; `window` is the dialogs' parent.
class PictureFlow : public QObject {
    Q_OBJECT
public:
    struct Parts {
        ViewportHost& host;
        SettingsStore& settings;
        FileDialogs& dialogs;
        MessageBar& messages;
    };
    PictureFlow(model::Session& session, const Parts& parts, QWidget* window);

    void ask();

private:
    void askName(const PictureChoice& choice);
    void save(const PictureChoice& choice, const QString& path);
    PictureChoice lastChoice() const;
    void remember(const PictureChoice& choice);

    model::Session& session_;
    Parts parts_;
    QWidget* window_;
};

} // namespace isoslider::widgets
