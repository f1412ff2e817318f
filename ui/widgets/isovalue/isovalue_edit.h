#pragma once

#include <optional>

#include <QLineEdit>

#include "core/grid/value_spread.h"
#include "ui/widgets/common/refusal_tip.h"

namespace isoslider::widgets {

/// A number typed in data units, or in standard deviations from the mean: taken on Enter or when the focus leaves, put
/// back on Escape or if it is not a number, with a tip on why while the user is in it. Never rewritten while the user
/// types.
class IsovalueEdit : public QLineEdit {
    Q_OBJECT
public:
    explicit IsovalueEdit(QWidget* parent = nullptr);

    void showValue(double value);
    void showNothing();
    /// What "2.5 sigma" refers to; none without a volume.
    void setSpread(std::optional<ValueSpread> spread) { spread_ = spread; }

Q_SIGNALS:
    void valueCommitted(double value);
    void stepRequested(double rangeFraction);

protected:
    bool event(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

private:
    void commit();
    void restore();
    void refuse(const QString& reason);
    void hideReason();

    std::optional<double> typedValue();

    std::optional<ValueSpread> spread_;
    QString shownText_;
    RefusalTip refusal_;
    bool isCut_ = false; ///< what was put in was longer than fits: what is there is not what was meant
};

} // namespace isoslider::widgets
