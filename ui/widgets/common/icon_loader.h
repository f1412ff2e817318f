#pragma once

#include <QIcon>
#include <QPalette>
#include <QString>

namespace isoslider::widgets {

/// A built-in icon in the palette's text colours (normal and disabled).
QIcon themedIcon(const QString& name, const QPalette& palette);
/// The same picture in one colour, for labels.
QPixmap themedPixmap(const QString& name, const QColor& colour, int size, qreal devicePixelRatio);

} // namespace isoslider::widgets
