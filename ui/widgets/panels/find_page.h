#pragma once

#include <vector>

#include <QWidget>

#include "ui/model/observers.h"
#include "ui/model/topology/suggested_isovalue.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QTreeWidget;
class QTreeWidgetItem;

namespace isoslider::model {
class QuestionModel;
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

/// Isovalues worth a look, each with its reason, and a search for those whose surface has a number of pieces, an area
/// and the like. A click on one, or Enter, picks it.
class FindPage : public QWidget {
    Q_OBJECT
public:
    FindPage(model::Session& session, model::QuestionModel& question, QWidget* parent = nullptr);

    void focusValue();

Q_SIGNALS:
    void isovaluePicked(double isovalue);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    QWidget* makeQuestion();
    QTreeWidget* makeList(const char* name, const QString& accessibleName);
    void pick(const QTreeWidgetItem* item);
    void pickNextFound();
    void ask();
    void showSuggestions();
    void markPresent();
    void showKnown();
    void showPresentValue();
    void showAnswer();
    void fitSuggestions();
    QString unitText() const;

    model::Session& session_;
    model::QuestionModel& question_;
    std::vector<model::SuggestedIsovalue> listed_;
    QTreeWidget* suggestions_ = nullptr;
    QComboBox* quantity_ = nullptr;
    QLineEdit* value_ = nullptr;
    QLabel* unit_ = nullptr;
    QLabel* answer_ = nullptr;
    QTreeWidget* found_ = nullptr;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
