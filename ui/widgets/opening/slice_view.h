#pragma once

#include <QImage>
#include <QWidget>

#include "ui/model/opening/volume_preview.h"
#include "ui/model/surface/axis_names.h"

namespace isoslider::widgets {

/// A plane of samples in shades of grey, in its true proportions, under a line that states which it is. Rows
/// run down across z, as in a stack of pictures, and up otherwise, so that z points up.
class SliceView : public QWidget {
    Q_OBJECT
public:
    explicit SliceView(int axis, QWidget* parent = nullptr);
    void setSlice(const model::SliceImage& slice, const model::AxisNames& names = {});
    void clear();
    /// Dims what is shown while another is being read.
    void setStale(bool isStale);
    QSize sizeHint() const override { return {210, 232}; }
    QSize minimumSizeHint() const override { return {110, 130}; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    QRectF imageRect() const;

    int axis_;
    QImage image_;
    double aspect_ = 1.0; ///< width to height, in units of length
    QString caption_;
    bool isStale_ = false;
};

} // namespace isoslider::widgets
