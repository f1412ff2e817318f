#include "ui/widgets/common/text_colour.h"

#include <algorithm>
#include <cmath>

#include <QEvent>
#include <QLabel>

namespace isoslider::widgets {
namespace {

constexpr double kLeastContrast = 4.5;
constexpr double kQuietest = 0.6; // part of the text's colour
constexpr int kSteps = 20;

double linear(double channel) {
    return channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4);
}

double luminance(const QColor& colour) {
    return 0.2126 * linear(colour.redF()) + 0.7152 * linear(colour.greenF()) + 0.0722 * linear(colour.blueF());
}

QColor mixed(const QColor& front, const QColor& back, double part) {
    const auto channel = [part](double a, double b) { return static_cast<float>(part * a + (1.0 - part) * b); };
    return QColor::fromRgbF(channel(front.redF(), back.redF()), channel(front.greenF(), back.greenF()),
                            channel(front.blueF(), back.blueF()));
}

/// Sets the label's colour again whenever its palette changes.
class QuietText : public QObject {
public:
    explicit QuietText(QLabel* label) : QObject(label), label_(label) {
        label->installEventFilter(this);
        apply();
    }

protected:
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (event->type() == QEvent::PaletteChange || event->type() == QEvent::ParentChange)
            apply();
        return QObject::eventFilter(watched, event);
    }

private:
    void apply() {
        const QWidget* parent = label_->parentWidget();
        const QColor colour = quietTextColour(parent != nullptr ? parent->palette() : QPalette());
        if (label_->palette().color(QPalette::WindowText) == colour)
            return; // setting it is a change of the palette, too
        QPalette own;
        own.setColor(QPalette::WindowText, colour);
        label_->setPalette(own);
    }

    QLabel* label_;
};

} // namespace

double contrastOf(const QColor& front, const QColor& back) {
    const double a = luminance(mixed(front, back, front.alphaF()));
    const double b = luminance(back);
    return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
}

QColor quietTextColour(const QPalette& palette, QPalette::ColorRole text, QPalette::ColorRole background) {
    const QColor front = palette.color(QPalette::Active, text);
    const QColor back = palette.color(QPalette::Active, background);
    for (int step = 0; step < kSteps; ++step) {
        const QColor quiet = mixed(front, back, std::lerp(kQuietest, 1.0, static_cast<double>(step) / kSteps));
        if (contrastOf(quiet, back) >= kLeastContrast)
            return quiet;
    }
    return front;
}

void makeQuiet(QLabel* label) { new QuietText(label); }

} // namespace isoslider::widgets
