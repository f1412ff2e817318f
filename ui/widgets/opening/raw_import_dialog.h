#pragma once

#include <array>
#include <memory>

#include <QDialog>

#include "ui/model/opening/raw_import_model.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QPushButton;
class QSpinBox;
class QTableView;
class QVBoxLayout;

namespace isoslider::widgets {

class PreviewPane;
class TextTableModel;

/// Asks what a headerless file holds: offers the ways to read it that suggest themselves, and shows at once
/// how each looks. Opens only what fits the file's size.
class RawImportDialog : public QDialog {
    Q_OBJECT
public:
    explicit RawImportDialog(std::unique_ptr<model::RawImportModel> model, QWidget* parent = nullptr);
    ~RawImportDialog() override;

Q_SIGNALS:
    void openRequested(const QString& path, const isoslider::io::ReadOptions& options);

private:
    QWidget* makeLeft();
    void makeGuesses(QVBoxLayout* rows, QWidget* page);
    void makeForm(QVBoxLayout* rows, QWidget* page);
    void makeWarning(QVBoxLayout* rows, QWidget* page);
    void takeLayout();
    void showState();
    void showLayout();
    void showGuesses();
    void showFit();

    std::unique_ptr<model::RawImportModel> model_;
    bool isShowing_ = false; ///< controls are being set, not used
    QLabel* guessHint_ = nullptr;
    QTableView* guesses_ = nullptr;
    TextTableModel* guessRows_ = nullptr;
    std::array<QSpinBox*, 3> dims_{};
    std::array<QDoubleSpinBox*, 3> spacing_{};
    QComboBox* type_ = nullptr;
    QSpinBox* skip_ = nullptr;
    QCheckBox* bigEndian_ = nullptr;
    QCheckBox* trailing_ = nullptr;
    QLabel* fit_ = nullptr;
    QWidget* warning_ = nullptr;
    QLabel* warningText_ = nullptr;
    PreviewPane* pane_ = nullptr;
    QPushButton* open_ = nullptr;
    model::Subscription subscription_;
};

} // namespace isoslider::widgets
