#include "ui/widgets/isovalue/isovalue_accessible.h"

#include <QAccessible>
#include <QAccessibleWidget>

#include "ui/model/isovalue/isovalue_model.h"
#include "ui/widgets/isovalue/histogram_plot.h"

namespace isoslider::widgets {
namespace {

class IsovalueAccessible final : public QAccessibleWidget, public QAccessibleValueInterface {
public:
    explicit IsovalueAccessible(HistogramPlot* plot) : QAccessibleWidget(plot, QAccessible::Slider), plot_(plot) {}

    void* interface_cast(QAccessible::InterfaceType type) override {
        if (type == QAccessible::ValueInterface)
            return static_cast<QAccessibleValueInterface*>(this);
        return QAccessibleWidget::interface_cast(type);
    }

    QVariant currentValue() const override { return plot_->requested(); }
    QVariant minimumValue() const override { return plot_->minimum(); }
    QVariant maximumValue() const override { return plot_->maximum(); }
    QVariant minimumStepSize() const override { return plot_->stepRule().unit / model::kPrecisionFactor; }
    void setCurrentValue(const QVariant& value) override { Q_EMIT plot_->isovalueRequested(value.toDouble()); }

private:
    HistogramPlot* plot_;
};

QAccessibleInterface* makeInterface(const QString&, QObject* object) {
    if (auto* plot = qobject_cast<HistogramPlot*>(object))
        return new IsovalueAccessible(plot);
    return nullptr;
}

} // namespace

void installIsovalueAccessibility() {
    static const bool isInstalled = [] {
        QAccessible::installFactory(makeInterface);
        return true;
    }();
    static_cast<void>(isInstalled);
}

void announceValue(HistogramPlot& plot) {
    if (!QAccessible::isActive())
        return;
    QAccessibleValueChangeEvent event(&plot, plot.requested());
    QAccessible::updateAccessibility(&event);
}

} // namespace isoslider::widgets
