#pragma once

#include <QString>
#include <QWidget>

#include "ui/model/colouring/colour_ticks.h"
#include "ui/model/colouring/colouring.h"

namespace isoslider::widgets {

/// Which colour stands for which value, legible on any picture; lets all pointer events through.
class ColourBarView : public QWidget {
    Q_OBJECT
public:
    static constexpr int kLeastHeight = 120;

    struct Content {
        QString title;
        QString unit; ///< may be empty
        model::ColourRange range;
        model::ColourMap map = model::ColourMap::Viridis;
        bool isReversed = false;
        bool hasMissing = false; ///< some places have no value

        bool operator==(const Content&) const = default;
    };

    explicit ColourBarView(QWidget* parent);

    /// Takes the width that it needs, and this height. REQUIRES: at least kLeastHeight.
    void setBar(const Content& content, int height);
    const Content& content() const { return content_; }
    const std::vector<model::ColourTick>& ticks() const { return ticks_; }
    void paint(QPainter& painter) const;
    /// Where a value of the range is, in coordinates of the widget.
    double yOf(double value) const;

protected:
    void paintEvent(QPaintEvent* event) override;
    void changeEvent(QEvent* event) override;

private:
    void layOut();
    QRectF strip() const;

    Content content_;
    std::vector<model::ColourTick> ticks_;
    int wantedHeight_ = kLeastHeight;
    int textWidth_ = 0; ///< of the widest tick
};

} // namespace isoslider::widgets
