#pragma once

#include <array>

#include <QWidget>

#include "ui/model/opening/preview_model.h"

class QCPGraph;
class QCustomPlot;
class QLabel;
class QProgressBar;

namespace isoslider::widgets {

class SliceView;

/// A volume before it is opened: three slices through its middle, its histogram, and a line on what that is
/// made of, on how far reading it is, or on why it cannot be shown.
class PreviewPane : public QWidget {
    Q_OBJECT
public:
    explicit PreviewPane(QWidget* parent = nullptr);

    void showPreview(const model::PreviewModel& preview);
    /// Instead of a preview: why there is none.
    void showProblem(const QString& text);
    QString statusText() const;

protected:
    void changeEvent(QEvent* event) override;

private:
    void makePlot();
    void applyPalette();
    void showVolume(const model::VolumePreview& volume);
    void showHistogram(const model::VolumePreview& volume);
    void clearVolume();
    void setStatus(const QString& text, bool isError);

    std::array<SliceView*, 3> slices_{};
    QCustomPlot* plot_ = nullptr;
    QCPGraph* counts_ = nullptr;
    QProgressBar* progress_ = nullptr;
    QLabel* status_ = nullptr;
    bool isError_ = false;
};

} // namespace isoslider::widgets
