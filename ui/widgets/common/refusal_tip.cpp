#include "ui/widgets/common/refusal_tip.h"

#include <utility>

#include <QToolTip>
#include <QWidget>

namespace isoslider::widgets {
namespace {

constexpr int kMostQuoted = 24;

} // namespace

QString quotedInput(const QString& text) {
    QString kept;
    int count = 0;
    for (const char32_t character : text.toUcs4()) {
        if (count++ == kMostQuoted) {
            kept += QChar(0x2026);
            break;
        }
        const bool isShown = QChar::isPrint(character) && QChar::category(character) != QChar::Other_Format;
        kept += isShown ? QString::fromUcs4(&character, 1) : QString(QChar::ReplacementCharacter);
    }
    // Isolated, so that words from right to left stay between the quotation marks.
    return QChar(0x2068) + kept + QChar(0x2069);
}

void RefusalTip::show(QWidget& field, const QString& reason) {
    // Escaped: tool tips take text with tags for a page.
    text_ = QStringLiteral("<qt>%1</qt>").arg(reason.toHtmlEscaped());
    QToolTip::showText(field.mapToGlobal(QPoint(0, field.height())), text_, &field);
}

void RefusalTip::hide() {
    const QString text = std::exchange(text_, QString());
    if (!text.isEmpty() && QToolTip::text() == text)
        QToolTip::hideText();
}

} // namespace isoslider::widgets
