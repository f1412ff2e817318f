#include "ui/widgets/window/crop_wiring.h"

#include "ui/model/session/session.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/viewport/viewport_host.h"

namespace isoslider::widgets {

CropWiring::CropWiring(model::Session& session, model::SliceModel& slices, ViewportHost& host, QObject* parent)
    : QObject(parent), session_(session), slices_(slices), host_(host) {
    subscriptions_.push_back(host_.viewState().observe([this] { follow(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { follow(); }));
    subscriptions_.push_back(slices_.observe([this] { follow(); }));
    follow();
}

void CropWiring::follow() {
    const model::Clipping& clipping = host_.viewState().options().clipping;
    session_.lookAt(clipping.isCropped && !slices_.showsContours() ? clipping.crop : std::nullopt);
}

} // namespace isoslider::widgets
