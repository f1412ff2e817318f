#include "ui/widgets/isovalue/histogram_hints.h"

#include <algorithm>
#include <cmath>

#include <QLabel>
#include <QToolButton>

#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/plot_style.h"

namespace isoslider::widgets {
namespace {

constexpr int kAside = 8;
constexpr int kBelowStars = 16; // of suggested isovalues, at the upper edge
constexpr int kLowestHintHeight = 48; // below it, there is room for the handle alone

QString textOf(double value) { return fromStd(model::valueText(value, 6)); }

} // namespace

HistogramHints::HistogramHints(HistogramPlot& plot)
    : QObject(&plot),
      plot_(plot),
      readout_(makeLabel("histogramReadout")),
      note_(makeLabel("isovalueNote")),
      lower_(makeButton("samplesBelow")),
      upper_(makeButton("samplesAbove")),
      handle_(makeButton("handleOutOfView")) {
    connect(lower_, &QToolButton::clicked, &plot_, &HistogramPlot::showWholeRange);
    connect(upper_, &QToolButton::clicked, &plot_, &HistogramPlot::showWholeRange);
    connect(&plot_, &QCustomPlot::afterLayout, this, [this] { // wider tick labels move the axes
        if (plot_.axisRect()->rect() != placedFor_)
            update();
    });
    connect(handle_, &QToolButton::clicked, &plot_, &HistogramPlot::showHandle);
    lower_->setToolTip(tr("Samples below what is in view. Click to show the whole range."));
    upper_->setToolTip(tr("Samples above what is in view. Click to show the whole range."));
    handle_->setToolTip(tr("The handle is out of view. Click to show it."));
}

QLabel* HistogramHints::makeLabel(const char* name) {
    auto* label = new QLabel(&plot_);
    label->setObjectName(QLatin1String(name));
    label->setAttribute(Qt::WA_TransparentForMouseEvents);
    label->setTextFormat(Qt::PlainText);
    label->setMargin(3);
    label->hide();
    return label;
}

// The keyboard reaches what they do through the menu.
QToolButton* HistogramHints::makeButton(const char* name) {
    auto* button = new QToolButton(&plot_);
    button->setObjectName(QLatin1String(name));
    button->setFocusPolicy(Qt::NoFocus);
    button->setCursor(Qt::PointingHandCursor);
    button->hide();
    return button;
}

void HistogramHints::applyPalette() {
    const QPalette palette = plot_.palette();
    QColor background = palette.color(QPalette::Base);
    background.setAlpha(215);
    const QString chip = QStringLiteral("background: %1; color: %2; border: none; padding: 1px 4px;")
                             .arg(background.name(QColor::HexArgb));
    const QString quiet = quietTextColour(palette, QPalette::Text, QPalette::Base).name();
    readout_->setStyleSheet(chip.arg(palette.color(QPalette::Text).name()));
    note_->setStyleSheet(chip.arg(palette.color(QPalette::Text).name()));
    for (QToolButton* button : {lower_, upper_})
        button->setStyleSheet(QStringLiteral("QToolButton { %1 }").arg(chip.arg(quiet)));
    const PlotColours colours = plotColours(palette);
    handle_->setStyleSheet(QStringLiteral("QToolButton { background: %1; color: %2; border: none; padding: 1px 5px; }")
                               .arg(colours.handle.name(), colours.handleText.name()));
}

void HistogramHints::update() {
    const bool hasHistogram = plot_.hasHistogram() && !plot_.view().values().isEmpty();
    if (!hasHistogram) {
        for (QWidget* widget : {static_cast<QWidget*>(lower_), static_cast<QWidget*>(upper_),
                                static_cast<QWidget*>(handle_), static_cast<QWidget*>(readout_)})
            widget->hide();
        return;
    }
    const auto& view = plot_.view();
    const auto& values = view.values();
    const QRect rect = placedFor_ = plot_.axisRect()->rect();
    const auto shown = plot_.visibleRange();
    const auto beyond = view.beyond({shown.lower, shown.upper});
    const QString about = values.isExact() ? QString() : QStringLiteral("≈ ");
    const auto describe = [&](std::uint64_t count) {
        return count == 0 ? tr("samples") : count == 1 ? tr("1 sample") : about + tr("%1 samples").arg(grouped(count));
    };
    const int middle = rect.top() + rect.height() / 2;
    const bool isLow = rect.height() < kLowestHintHeight;
    // Of rounding at the ends nothing is said.
    place(*lower_, !isLow && values.min < shown.lower && (beyond.below > 0 || values.min < view.usualRange().lower),
          tr("◂ %1 down to %2").arg(describe(beyond.below), textOf(values.min)), true, middle);
    place(*upper_, !isLow && values.max > shown.upper && (beyond.above > 0 || values.max > view.usualRange().upper),
          tr("%1 up to %2 ▸").arg(describe(beyond.above), textOf(values.max)), false, middle);
    updateHandle();
    placeNote();
}

void HistogramHints::updateHandle() {
    if (!plot_.hasHistogram())
        return handle_->hide();
    const auto shown = plot_.visibleRange();
    const double handle = plot_.requested();
    const bool isBelow = handle<shown.lower, isAbove = handle> shown.upper;
    place(*handle_, isBelow || isAbove, isBelow ? tr("◂ %1").arg(textOf(handle)) : tr("%1 ▸").arg(textOf(handle)),
          isBelow, plot_.axisRect()->top() - 10);
}

void HistogramHints::place(QToolButton& button, bool isShown, const QString& text, bool isLeft, int y) {
    button.setVisible(isShown);
    if (!isShown)
        return;
    const QRect rect = plot_.axisRect()->rect();
    button.setText(text);
    button.setAccessibleName(text);
    button.adjustSize();
    button.move(isLeft ? rect.left() + 2 : rect.right() - button.width() - 1, y - button.height() / 2);
}

QString HistogramHints::readoutText(double pixel, bool statesDeviations) const {
    const double value = plot_.valueAtPixel(pixel);
    const auto readout = plot_.readoutAt(pixel);
    if (!readout)
        return {};
    const double resolution = plot_.resolutionAt(value);
    const auto number = [&](double v) { return QString::fromStdString(model::resolvedText(v, resolution)); };
    const QString about = readout->isExact ? QString() : QStringLiteral("≈ ");
    const QString count =
        about + (readout->count == 1 ? tr("1 sample") : tr("%1 samples").arg(grouped(readout->count)));
    const QString where =
        readout->lower == readout->upper
            ? tr("%1 at %2").arg(count, QString::fromStdString(model::valueText(readout->lower, 7)))
            : tr("%1 in %2 … %3")
                  .arg(count,
                       QString::fromStdString(
                           model::resolvedText(readout->lower, (readout->upper - readout->lower) / 2.0)),
                       QString::fromStdString(
                           model::resolvedText(readout->upper, (readout->upper - readout->lower) / 2.0)));
    // Not 100 % where a few are above.
    const double percent = 100.0 * readout->shareBelow;
    const int digits = percent > 99.0 && percent < 100.0 ? 3 : percent < 1.0 ? 3 : 1;
    const double shown = percent < 100.0 ? std::min(percent, 99.999) : 100.0;
    const QString deviations =
        statesDeviations ? fromStd(model::deviationsText(value, plot_.view().values().spread)) : QString();
    return tr("%1  ·  %2  ·  %3 % below")
        .arg(deviations.isEmpty() ? number(value) : tr("%1  ·  %2").arg(number(value), deviations), where,
             QString::number(shown, 'f', digits));
}

void HistogramHints::showReadout(double pixel) {
    const QString text = readoutText(pixel, true);
    readout_->setVisible(!text.isEmpty());
    if (text.isEmpty())
        return;
    readout_->setText(text);
    const QRect rect = plot_.axisRect()->rect();
    readout_->setWordWrap(false);
    QSize size = readout_->sizeHint();
    if (size.width() > rect.width()) { // standard deviations are the first to be left out
        readout_->setText(readoutText(pixel, false));
        size = readout_->sizeHint();
    }
    if (size.width() > rect.width()) { // the labels of the axes stay legible
        readout_->setWordWrap(true);
        size = {rect.width(), readout_->heightForWidth(rect.width())};
    }
    const int x = static_cast<int>(pixel);
    const int wanted = x > rect.center().x() ? x - kAside - size.width() : x + kAside;
    const int below = rect.height() > kBelowStars + 2 * size.height() ? kBelowStars : 2;
    readout_->setGeometry(std::clamp(wanted, rect.left(), std::max(rect.left(), rect.right() + 1 - size.width())),
                          rect.top() + below, size.width(), size.height());
    readout_->raise();
}

void HistogramHints::hideReadout() { readout_->hide(); }

void HistogramHints::setNote(const QString& note) {
    if (note == note_->text())
        return;
    note_->setText(note);
    note_->setVisible(!note.isEmpty());
    placeNote();
}

// Above the axis, where the outline rarely is of interest; the legend is at the top.
void HistogramHints::placeNote() {
    if (note_->text().isEmpty())
        return;
    const QRect rect = plot_.axisRect()->rect();
    note_->setWordWrap(false);
    QSize size = note_->sizeHint();
    if (size.width() > rect.width()) {
        note_->setWordWrap(true);
        size = {rect.width(), note_->heightForWidth(rect.width())};
    }
    note_->setGeometry(rect.left() + (rect.width() - size.width()) / 2, rect.bottom() - size.height() - 4, size.width(),
                       size.height());
    note_->raise();
}

} // namespace isoslider::widgets
