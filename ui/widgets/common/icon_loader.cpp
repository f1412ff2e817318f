#include "ui/widgets/common/icon_loader.h"

#include <QFile>
#include <QPainter>
#include <QPixmap>
#include <QSvgRenderer>

namespace isoslider::widgets {

QPixmap themedPixmap(const QString& name, const QColor& colour, int size, qreal devicePixelRatio) {
    QFile file(QStringLiteral(":/isoslider/icons/%1.svg").arg(name));
    QPixmap pixmap(QSize(size, size) * devicePixelRatio);
    pixmap.setDevicePixelRatio(devicePixelRatio);
    pixmap.fill(Qt::transparent);
    if (!file.open(QIODevice::ReadOnly))
        return pixmap;
    QSvgRenderer renderer(file.readAll().replace("currentColor", colour.name().toLatin1()));
    QPainter painter(&pixmap);
    renderer.render(&painter, QRectF(0, 0, size, size));
    return pixmap;
}

QIcon themedIcon(const QString& name, const QPalette& palette) {
    QIcon icon;
    for (const int size : {16, 20, 24, 32})
        for (const qreal ratio : {1.0, 2.0}) {
            icon.addPixmap(themedPixmap(name, palette.color(QPalette::Active, QPalette::WindowText), size, ratio));
            icon.addPixmap(themedPixmap(name, palette.color(QPalette::Disabled, QPalette::WindowText), size, ratio),
                           QIcon::Disabled);
        }
    return icon;
}

} // namespace isoslider::widgets
