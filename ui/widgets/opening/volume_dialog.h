#pragma once

#include <array>

#include <QDialog>

#include "ui/model/opening/open_model.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QSlider;
class QSpinBox;
class QVBoxLayout;

namespace isoslider::widgets {

class FactForm;
class FieldTreeView;
class PreviewPane;

/// Shows a file or folder before it is opened, and asks which of its volumes to open: field or series,
/// component, frame, and the size of a grid that has to be resampled.
class VolumeDialog : public QDialog {
    Q_OBJECT
public:
    explicit VolumeDialog(std::unique_ptr<model::OpenModel> model, QWidget* parent = nullptr);
    ~VolumeDialog() override;

    /// Shows the switch that keeps this dialog from coming up for files with nothing to choose.
    void offerPreviewsFirst(bool isOn);

Q_SIGNALS:
    void openRequested(const QString& path, const isoslider::io::ReadOptions& options);
    void previewsFirstToggled(bool isOn);

private:
    QWidget* makeLeft();
    void makeFields(QVBoxLayout* rows, QWidget* page);
    void makeChoices(QVBoxLayout* rows, QWidget* page);
    void makeSizeRow(QWidget* page);
    void change(const std::function<void(model::VolumeChoice&)>& function);
    void showFields(const model::VolumeChoice& choice);
    void showChoices(const model::VolumeChoice& choice);
    void showFacts(const model::VolumeChoice& choice);
    void showState();

    std::unique_ptr<model::OpenModel> model_;
    bool isShowing_ = false; ///< controls are being set, not used
    QLabel* fieldsHeading_ = nullptr;
    FieldTreeView* fields_ = nullptr;
    QWidget* choices_ = nullptr;
    QLabel* componentName_ = nullptr;
    QComboBox* component_ = nullptr;
    QLabel* frameName_ = nullptr;
    QWidget* frameRow_ = nullptr;
    QSlider* frameSlider_ = nullptr;
    QSpinBox* frame_ = nullptr;
    QLabel* sizeName_ = nullptr;
    QWidget* sizeRow_ = nullptr;
    std::array<QSpinBox*, 3> size_{};
    FactForm* facts_ = nullptr;
    PreviewPane* pane_ = nullptr;
    QCheckBox* previewsFirst_ = nullptr;
    QPushButton* open_ = nullptr;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
