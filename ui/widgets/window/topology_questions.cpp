#include "ui/widgets/window/topology_questions.h"

#include <QAction>
#include <QApplication>
#include <QMenu>

#include "ui/model/session/session.h"
#include "ui/model/topology/question_model.h"
#include "ui/widgets/isovalue/axis_highlights.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/panels/topology_panel.h"
#include "ui/widgets/viewport/first_isovalue_note.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr int kHandsOffMs = 150;

} // namespace

TopologyQuestions::TopologyQuestions(model::Session& session, const ActionRegistry& actions, const Parts& parts,
                                     QObject* parent)
    : QObject(parent),
      session_(session),
      actions_(actions),
      panel_(parts.panel),
      menu_(parts.suggestions),
      highlights_(new AxisHighlights(parts.plot)) {
    handsOff_.setSingleShot(true);
    handsOff_.setInterval(kHandsOffMs);
    connect(&handsOff_, &QTimer::timeout, this, &TopologyQuestions::improveFirst);
    menu_.setToolTipsVisible(true);
    new FirstIsovalueNote(session_, parts.host.viewState(), parts.host);
    connectActions();
    connectParts();
    showDataset();
    showReference();
}

void TopologyQuestions::connectActions() {
    connect(actions_.action("isovalue.compare"), &QAction::triggered, this, [this] {
        session_.isovalue().setReference(session_.isovalue().requested());
        panel_.showComparison();
    });
    connect(actions_.action("isovalue.stopComparing"), &QAction::triggered, this,
            [this] { session_.isovalue().setReference(std::nullopt); });
    connect(actions_.action("isovalue.find"), &QAction::triggered, this, [this] { panel_.showSearch(); });
    // What is checked, kept or compared is not exchanged for another surface.
    for (const char* use : {"mesh.check", "mesh.export", "file.saveImage", "file.saveSession", "isovalue.compare"})
        connect(actions_.action(use), &QAction::triggered, this, [this] { session_.firstIsovalue().keep(); });
}

void TopologyQuestions::connectParts() {
    connect(highlights_, &AxisHighlights::suggestionPressed, this, &TopologyQuestions::slideTo);
    connect(&panel_, &TopologyPanel::isovaluePicked, this, &TopologyQuestions::slideTo);
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showDataset(); }));
    subscriptions_.push_back(session_.isovalue().observe([this] { showReference(); }));
    subscriptions_.push_back(session_.topology().changed().observe([this] {
        showSuggestions();
        improveFirst();
    }));
    subscriptions_.push_back(
        panel_.question().changed().observe([this] { highlights_->setFound(panel_.question().found().intervals); }));
}

void TopologyQuestions::slideTo(double isovalue) {
    session_.firstIsovalue().keep();
    session_.isovalue().request(isovalue);
}

void TopologyQuestions::showDataset() {
    const bool hasDataset = session_.dataset() != nullptr;
    for (const char* id : {"isovalue.compare", "isovalue.find"})
        actions_.action(id)->setEnabled(hasDataset);
    showSuggestions();
}

void TopologyQuestions::showSuggestions() {
    const auto state = session_.topology().state();
    const bool isMoreToCome = state == model::TopologyState::None || state == model::TopologyState::Analysing;
    auto suggestions = session_.suggestions();
    if (suggestions == suggestions_ && isMoreToCome == isMoreToCome_)
        return;
    suggestions_ = std::move(suggestions);
    isMoreToCome_ = isMoreToCome;
    highlights_->setSuggestions(suggestions_);
    fillMenu();
}

void TopologyQuestions::fillMenu() {
    menu_.clear();
    menu_.setEnabled(!suggestions_.empty());
    int number = 0;
    for (const auto& one : suggestions_) {
        const QString text =
            QString::fromStdString(model::suggestionText(one)).replace(QLatin1Char('&'), QStringLiteral("&&"));
        auto* action = menu_.addAction(QStringLiteral("&%1  %2").arg(++number).arg(text));
        action->setStatusTip(tr("Slide to this isovalue"));
        connect(action, &QAction::triggered, this, [this, isovalue = one.isovalue] { slideTo(isovalue); });
    }
    if (isMoreToCome_ && !suggestions_.empty())
        menu_.addAction(tr("More once the topology is known"))->setEnabled(false);
}

void TopologyQuestions::showReference() {
    const auto reference = session_.isovalue().reference();
    actions_.action("isovalue.stopComparing")->setEnabled(reference.has_value());
    highlights_->setReference(reference);
}

// The surface is not exchanged under the user's hands: while a button is held, a menu or a dialog is open, or a value
// is being typed, the better isovalue waits.
bool TopologyQuestions::areHandsOn() {
    const auto* edit = qobject_cast<IsovalueEdit*>(QApplication::focusWidget());
    return QGuiApplication::mouseButtons() != Qt::NoButton || QApplication::activePopupWidget() != nullptr ||
           QApplication::activeModalWidget() != nullptr || (edit != nullptr && edit->isModified());
}

void TopologyQuestions::improveFirst() {
    if (!session_.firstIsovalue().canImprove() || session_.topology().suggestions().empty())
        return handsOff_.stop();
    if (areHandsOn())
        return handsOff_.start();
    session_.improveFirstIsovalue();
}

} // namespace isoslider::widgets
