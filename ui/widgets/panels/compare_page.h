#pragma once

#include <array>
#include <optional>
#include <vector>

#include <QWidget>

#include "ui/model/observers.h"

class QLabel;
class QPushButton;
class QTableView;

namespace isoslider::model {
class Session;
struct Comparison;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class FactForm;
class TextTableModel;

/// What lies between the reference isovalue and the one on screen, while it moves.
class ComparePage : public QWidget {
    Q_OBJECT
public:
    ComparePage(model::Session& session, const ActionRegistry& actions, QWidget* parent = nullptr);

Q_SIGNALS:
    /// To the reference, and from there back.
    void isovaluePicked(double isovalue);

protected:
    void showEvent(QShowEvent* event) override;

private:
    QWidget* makeButtons(const ActionRegistry& actions);
    void makeTable();
    void showComparison();
    void compareAgain();
    void showSides(const model::Comparison& comparison);
    void showBetween(const model::Comparison& comparison);

    model::Session& session_;
    TextTableModel* sides_;
    QTableView* table_ = nullptr;
    QPushButton* swap_ = nullptr;
    QLabel* hint_ = nullptr;
    QWidget* betweenHeading_ = nullptr;
    QWidget* between_ = nullptr;
    FactForm* pieces_ = nullptr; ///< side by side, so that all is in sight
    FactForm* others_ = nullptr;
    std::optional<std::array<double, 2>> compared_; ///< reference and isovalue of what is shown
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
