#pragma once

#include <vector>

#include <QObject>

#include "ui/model/observers.h"

namespace isoslider::model {
class Session;
class SliceModel;
} // namespace isoslider::model

namespace isoslider::widgets {

class ViewportHost;

/// While a crop box hides the rest and no slice shows where the surface cuts it, the surface slides in the box only.
/// Everything it is given must outlive it.
class CropWiring : public QObject {
    Q_OBJECT
public:
    CropWiring(model::Session& session, model::SliceModel& slices, ViewportHost& host, QObject* parent);

private:
    void follow();

    model::Session& session_;
    model::SliceModel& slices_;
    ViewportHost& host_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
