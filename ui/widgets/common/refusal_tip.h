#pragma once

#include <QString>

class QWidget;

namespace isoslider::widgets {

/// What was typed, for a sentence about it: its beginning, without what would turn or break the sentence.
QString quotedInput(const QString& text);

/// States below a field why what was typed there was not taken, until it is hidden or another tip comes.
class RefusalTip {
public:
    void show(QWidget& field, const QString& reason);
    void hide();

private:
    QString text_; ///< as the tip has it; empty: there is none
};

} // namespace isoslider::widgets
