#pragma once

#include <cstdint>
#include <vector>

#include <QObject>
#include <QTimer>
#include <QUndoStack>

#include "ui/model/observers.h"
#include "ui/model/session/scene_state.h"

namespace isoslider::model {
class ColourModel;
class Session;
class SliceModel;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;

/// Undo and redo of what a user changes in the scene of one volume. Changes that follow each other closely, or while a
/// button of the mouse is held, are one step: a drag is. Another volume begins without a history.
class UndoHistory : public QObject {
    Q_OBJECT
public:
    struct Models {
        model::Session& session;
        model::ViewState& view;
        model::SliceModel& slices;
        model::ColourModel& colours;
    };
    UndoHistory(const Models& models, const ActionRegistry& actions, QObject* parent);
    ~UndoHistory() override;

    void undo();
    void redo();

private:
    class Step;

    model::SceneState capture() const;
    void apply(const model::SceneState& state);
    void noteChange();
    void noteSurfaces();
    bool isOfThisVolume() const;
    void record();
    void forget();
    void showActions();

    Models models_;
    const ActionRegistry& actions_;
    QUndoStack stack_;
    QTimer timer_;
    model::SceneState last_;
    bool isApplying_ = false;
    bool isNew_ = true; ///< the volume: what is set until its first surface is there is no step
    std::uint64_t dataset_ = 0;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
