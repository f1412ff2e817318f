#pragma once

#include <array>

#include <QDialog>

#include "ui/model/observers.h"
#include "ui/model/surface/axis_names.h"
#include "ui/model/surface/view_state.h"

class QDoubleSpinBox;
class QLabel;
class QPushButton;

namespace isoslider::model {
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

/// How many times as long the volume's axes are drawn. Changes count at once. Not modal; deletes itself when it is
/// closed.
class StretchDialog : public QDialog {
    Q_OBJECT
public:
    StretchDialog(const model::Session& session, model::ViewState& view, QWidget* parent);

private:
    void set(const glm::dvec3& stretch);
    model::AxisNames axisNames() const;
    int axisInRow(int row) const;
    void showState();

    const model::Session& session_;
    model::ViewState& view_;
    std::array<QLabel*, 3> names_{}; ///< one for each row, in the order of model::AxisNames, and so are those below
    std::array<QDoubleSpinBox*, 3> factors_{};
    std::array<QLabel*, 3> sides_{};
    QPushButton* suggested_;
    QPushButton* none_;
    std::array<model::Subscription, 2> subscriptions_;
};

} // namespace isoslider::widgets
