#include "ui/widgets/common/copying.h"

#include <QAction>
#include <QClipboard>
#include <QGuiApplication>
#include <QHeaderView>
#include <QString>
#include <QStringList>
#include <QTableView>

namespace isoslider::widgets {
namespace {

// Of the headings where `row` is -1. Columns without one have boxes or icons, no text.
QString lineOf(const QTableView& view, int row) {
    QStringList texts;
    for (int visual = 0; visual < view.horizontalHeader()->count(); ++visual) {
        const int column = view.horizontalHeader()->logicalIndex(visual);
        QString text = view.model()->headerData(column, Qt::Horizontal, Qt::DisplayRole).toString();
        if (view.isColumnHidden(column) || text.isEmpty())
            continue;
        if (row >= 0)
            text = view.model()->index(row, column).data(Qt::DisplayRole).toString();
        text.replace(QLatin1Char('\t'), QLatin1Char(' ')).replace(QLatin1Char('\n'), QLatin1Char(' '));
        texts.push_back(text);
    }
    return texts.join(QLatin1Char('\t')) + QLatin1Char('\n');
}

// Of all rows where `row` is -1.
QString tableText(const QTableView& view, int row) {
    QString text = lineOf(view, -1);
    if (row >= 0)
        return text + lineOf(view, row);
    for (int each = 0; each < view.model()->rowCount(); ++each)
        text += lineOf(view, each);
    return text;
}

} // namespace

void offerCopying(QTableView& view) {
    auto* one = new QAction(QTableView::tr("Co&py Row"), &view);
    one->setObjectName(QStringLiteral("copyRow"));
    one->setShortcut(QKeySequence::Copy);
    one->setShortcutContext(Qt::WidgetShortcut); // of the table that has the focus
    QObject::connect(one, &QAction::triggered, &view, [&view] {
        if (const QModelIndex index = view.currentIndex(); index.isValid())
            QGuiApplication::clipboard()->setText(tableText(view, index.row()));
    });
    auto* all = new QAction(QTableView::tr("Copy A&ll Rows"), &view);
    all->setObjectName(QStringLiteral("copyAllRows"));
    QObject::connect(all, &QAction::triggered, &view,
                     [&view] { QGuiApplication::clipboard()->setText(tableText(view, -1)); });
    if (!view.actions().isEmpty()) {
        auto* separator = new QAction(&view);
        separator->setSeparator(true);
        view.addAction(separator);
    }
    view.addAction(one);
    view.addAction(all);
    view.setContextMenuPolicy(Qt::ActionsContextMenu);
}

} // namespace isoslider::widgets
