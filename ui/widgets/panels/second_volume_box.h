#pragma once

#include <QWidget>

#include "ui/model/observers.h"

class QLabel;
class QSlider;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class ElidedLabel;

/// The second volume: its name, its surfaces, and the isovalue of the one that is selected. Hidden without one.
class SecondVolumeBox : public QWidget {
    Q_OBJECT
public:
    SecondVolumeBox(model::Session& session, const ActionRegistry& actions, QWidget* parent);

signals:
    /// A volume is there that was not.
    void opened();

private:
    void makeIsovalue();
    void showVolume();
    QString remark() const;
    void showIsovalue();

    model::Session& session_;
    ElidedLabel* name_;
    QWidget* surfaces_; ///< what there is only once the volume is
    QSlider* isovalue_ = nullptr;
    QLabel* isovalueText_ = nullptr;
    model::Subscription volumeSubscription_, surfacesSubscription_;
};

} // namespace isoslider::widgets
