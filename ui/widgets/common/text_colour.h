#pragma once

#include <QColor>
#include <QPalette>

class QLabel;

namespace isoslider::widgets {

/// Ratio of luminances as WCAG 2 defines it, 1 to 21. `front` may be translucent.
double contrastOf(const QColor& front, const QColor& back);

/// For what is stated in a lower voice: between the colours of text and background, as far from the text's as leaves a
/// contrast of 4.5 where the text itself has it. Not QPalette::PlaceholderText, which a dark palette of the system may
/// lack: then it is black.
QColor quietTextColour(const QPalette& palette, QPalette::ColorRole text = QPalette::WindowText,
                       QPalette::ColorRole background = QPalette::Window);

/// Shows a label in that colour, also when the palette changes.
void makeQuiet(QLabel* label);

} // namespace isoslider::widgets
