#pragma once

#include <QDialog>

#include "ui/widgets/viewport/picture_choice.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QSpinBox;

namespace isoslider::widgets {

/// Asks how large a picture of the view is to be, and whether it has a background. Deletes itself when it is closed.
class PictureDialog : public QDialog {
    Q_OBJECT
public:
    /// `view`: its size in pixels.
    PictureDialog(const PictureChoice& last, QSize view, QWidget* parent);

    PictureChoice choice() const;

Q_SIGNALS:
    void chosen(const PictureChoice& choice);

private:
    void showSize();

    QSize view_;
    int ownWidth_; ///< last typed, whatever is shown
    QComboBox* scale_;
    QSpinBox* width_;
    QLabel* height_;
    QCheckBox* transparent_;
};

} // namespace isoslider::widgets
