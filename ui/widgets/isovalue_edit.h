#pragma once

#include <QLineEdit>

namespace isoslider::widgets {

/// A number typed in data units: taken on Enter or when the focus leaves, put back on Escape or if
/// it is not a number. Never rewritten while the user types.
class IsovalueEdit : public QLineEdit {
    Q_OBJECT
public:
    explicit IsovalueEdit(QWidget* parent = nullptr);

    void showValue(double value);
    void showNothing();

Q_SIGNALS:
    void valueCommitted(double value);
    void stepRequested(double rangeFraction);

protected:
    void keyPressEvent(QKeyEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

private:
    void commit();
    void restore();

    QString shownText_;
};

} // namespace isoslider::widgets
