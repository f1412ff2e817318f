#pragma once

#include <array>
#include <filesystem>

#include <QDialog>

#include "core/volume_io/volume_reader.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSpinBox;

namespace isoslider::widgets {

/// Asks what a headerless file holds. Starts from a guess; opens only what fits the file's size.
class RawImportDialog : public QDialog {
    Q_OBJECT
public:
    RawImportDialog(std::filesystem::path path, std::uint64_t fileBytes, QWidget* parent = nullptr);

    io::ReadOptions optionsAsked() const;

Q_SIGNALS:
    void openRequested(const QString& path, const isoslider::io::ReadOptions& options);

private:
    io::RawLayout layoutAsked() const;
    void makeForm();
    void showFit();

    std::filesystem::path path_;
    std::uint64_t fileBytes_;
    std::array<QSpinBox*, 3> dims_{};
    std::array<QDoubleSpinBox*, 3> spacing_{};
    QComboBox* type_ = nullptr;
    QSpinBox* skip_ = nullptr;
    QCheckBox* bigEndian_ = nullptr;
    QCheckBox* trailing_ = nullptr;
    QLabel* fit_ = nullptr;
    QPushButton* open_ = nullptr;
};

} // namespace isoslider::widgets
