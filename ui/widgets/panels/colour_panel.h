#pragma once

#include <optional>
#include <vector>

#include <QWidget>

#include "ui/model/colouring/colouring.h"
#include "ui/model/observers.h"
#include "ui/widgets/common/refusal_tip.h"

class QComboBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QVBoxLayout;

namespace isoslider::widgets {

class ActionRegistry;
class ElidedLabel;
class ViewportHost;

/// What surfaces are coloured by, with which map and range. Everything it is given must outlive it.
class ColourPanel : public QWidget {
    Q_OBJECT
public:
    ColourPanel(ViewportHost& host, const ActionRegistry& actions, QWidget* parent = nullptr);

private:
    void makeChoices(QGridLayout* grid);
    void makeRange(QVBoxLayout* rows);
    QLineEdit* makeEdit(const char* name, const QString& accessibleName);
    void takeRange();
    void showColours();
    void showKeys();
    void showRange();
    void refuse(const std::optional<double>& low, const std::optional<double>& high);
    void showNote();
    /// What is coloured by values has a map and a range.
    void enableMap();

    ViewportHost& host_;
    const ActionRegistry& actions_;
    QComboBox* key_ = nullptr;
    QComboBox* map_ = nullptr;
    ElidedLabel* field_ = nullptr; ///< the file of a second one
    QLineEdit* low_ = nullptr;
    QLineEdit* high_ = nullptr;
    QLabel* note_ = nullptr;
    QString refusal_; ///< why the range that was typed last was not taken; empty: it was
    RefusalTip refusalTip_;
    model::ColourBy shownBy_ = model::ColourBy::One;
    std::vector<QLabel*> mapNames_; ///< of the controls of map and range
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
