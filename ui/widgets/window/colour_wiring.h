#pragma once

#include <array>
#include <memory>
#include <vector>

#include <QObject>
#include <QString>

#include "ui/model/colouring/colour_model.h"

class QMenu;
class QWidget;

namespace isoslider::widgets {

class ActionRegistry;
class FileDialogs;
class SettingsStore;
class ViewportHost;

struct ColourKeyAction {
    const char* id;
    model::ColourBy by;
};
inline constexpr std::array<ColourKeyAction, 7> kColourKeyActions{{{"colour.one", model::ColourBy::One},
                                                                   {"colour.gradient", model::ColourBy::Gradient},
                                                                   {"colour.x", model::ColourBy::X},
                                                                   {"colour.y", model::ColourBy::Y},
                                                                   {"colour.z", model::ColourBy::Z},
                                                                   {"colour.middle", model::ColourBy::Middle},
                                                                   {"colour.field", model::ColourBy::Field}}};

struct ColourMapAction {
    const char* id;
    model::ColourMap map;
};
inline constexpr std::array<ColourMapAction, 5> kColourMapActions{
    {{"colour.viridis", model::ColourMap::Viridis},
     {"colour.magma", model::ColourMap::Magma},
     {"colour.cividis", model::ColourMap::Cividis},
     {"colour.blueWhiteRed", model::ColourMap::BlueWhiteRed},
     {"colour.grey", model::ColourMap::Grey}}};

/// The actions that colour surfaces, and the way to a second field. Everything it is given must outlive it.
class ColourWiring : public QObject {
    Q_OBJECT
public:
    struct Parts {
        SettingsStore& settings;
        FileDialogs& dialogs;
        ViewportHost& host;
    };
    ColourWiring(model::Session& session, const ActionRegistry& actions, const Parts& parts, QWidget* window);

    /// What the menu View has of it.
    static void addTo(QMenu& menu, const ActionRegistry& actions);

private:
    void connectActions();
    void askField();
    void chooseField(const QString& path);
    void showState();

    model::Session& session_;
    const ActionRegistry& actions_;
    Parts parts_;
    QWidget* window_;
    model::ColourModel& colours_;
    std::shared_ptr<model::BackgroundJobs> jobs_; ///< of the dialogs
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
