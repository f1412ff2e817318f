#include "ui/widgets/opening/field_tree_model.h"

#include <algorithm>

#include <QGuiApplication>
#include <QPalette>

#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

constexpr int kColumns = 4;

/// Node of an index; the root's of an invalid one.
std::size_t nodeAt(const QModelIndex& index) { return static_cast<std::size_t>(index.internalId()); }

QString partsText(const io::VolumeField& field) {
    QStringList parts;
    if (field.components > 1)
        parts << FieldTreeModel::tr("%1 components").arg(field.components);
    if (field.frames > 1)
        parts << FieldTreeModel::tr("%1 frames").arg(field.frames);
    return parts.join(QStringLiteral(", "));
}

} // namespace

QString titleOf(const io::VolumeField& field) { return fromStd(field.title.empty() ? field.name : field.title); }

FieldTreeModel::FieldTreeModel(QString nameHeading, QObject* parent)
    : QAbstractItemModel(parent), nameHeading_(std::move(nameHeading)) {}

void FieldTreeModel::setContents(io::VolumeContents contents) {
    beginResetModel();
    contents_ = std::move(contents);
    tree_ = model::FieldTree(contents_);
    endResetModel();
}

bool FieldTreeModel::hasParts() const {
    return std::any_of(contents_.fields.begin(), contents_.fields.end(),
                       [](const auto& field) { return !partsText(field).isEmpty(); });
}

std::optional<std::size_t> FieldTreeModel::fieldAt(const QModelIndex& index) const {
    return index.isValid() ? tree_.node(nodeAt(index)).field : std::nullopt;
}

bool FieldTreeModel::isOneText(const QModelIndex& index) const {
    const auto field = fieldAt(index);
    return !field || !contents_.fields[*field].problem.empty();
}

QModelIndex FieldTreeModel::indexOf(std::size_t field) const {
    const std::size_t node = tree_.nodeOf(field);
    return createIndex(static_cast<int>(tree_.node(node).row), 0, node);
}

QModelIndex FieldTreeModel::index(int row, int column, const QModelIndex& parent) const {
    if (!hasIndex(row, column, parent))
        return {};
    const auto& children = tree_.node(parent.isValid() ? nodeAt(parent) : 0).children;
    return createIndex(row, column, children[static_cast<std::size_t>(row)]);
}

QModelIndex FieldTreeModel::parent(const QModelIndex& child) const {
    const std::size_t above = child.isValid() ? tree_.node(nodeAt(child)).parent : 0;
    return above == 0 ? QModelIndex() : createIndex(static_cast<int>(tree_.node(above).row), 0, above);
}

int FieldTreeModel::rowCount(const QModelIndex& parent) const {
    if (parent.column() > 0)
        return 0;
    return static_cast<int>(tree_.node(parent.isValid() ? nodeAt(parent) : 0).children.size());
}

int FieldTreeModel::columnCount(const QModelIndex&) const { return kColumns; }

QString FieldTreeModel::textOf(const io::VolumeField& field, std::size_t node, int column) const {
    const QString name = tree_.hasGroups() ? fromStd(tree_.node(node).name) : titleOf(field);
    if (!field.problem.empty()) // in place of the other columns
        return column == Name ? tr("%1 – %2").arg(name, fromStd(field.problem)) : QString();
    switch (column) {
        case Name: return name;
        case GridPoints: return dimsText(field.dims);
        case Type: return fromStd(field.typeName);
        default: return partsText(field);
    }
}

QString FieldTreeModel::tipOf(const io::VolumeField& field) const {
    QStringList lines{fromStd(field.name)};
    if (!field.title.empty())
        lines.prepend(fromStd(field.title));
    if (!field.problem.empty())
        lines << tr("Cannot be opened: %1").arg(fromStd(field.problem));
    return plainTip(lines.join(QLatin1Char('\n')));
}

QVariant FieldTreeModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid() || !checkIndex(index))
        return {};
    if (role == Qt::TextAlignmentRole)
        return static_cast<int>((index.column() == Name ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
    const auto field = fieldAt(index);
    if (!field)
        return role == Qt::DisplayRole && index.column() == Name ? QVariant(fromStd(tree_.node(nodeAt(index)).name))
                                                                 : QVariant();
    const io::VolumeField& shown = contents_.fields[*field];
    switch (role) {
        case Qt::DisplayRole: return textOf(shown, nodeAt(index), index.column());
        case Qt::ToolTipRole: return tipOf(shown);
        case Qt::AccessibleDescriptionRole: return shown.problem.empty() ? QVariant() : QVariant(tipOf(shown));
        case Qt::ForegroundRole:
            return shown.problem.empty()
                       ? QVariant()
                       : QVariant(quietTextColour(QGuiApplication::palette(), QPalette::Text, QPalette::Base));
        default: return {};
    }
}

QVariant FieldTreeModel::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal || section < 0 || section >= kColumns)
        return {};
    const QString titles[] = {nameHeading_, tr("Grid points"), tr("Type"), tr("Parts")};
    const QString tips[] = {QString(), tr("Along x, y and z"), tr("Of the samples, in the file"),
                            tr("Components of each sample, and frames of a series")};
    switch (role) {
        case Qt::DisplayRole: return titles[section];
        case Qt::ToolTipRole: return tips[section];
        case Qt::TextAlignmentRole:
            return static_cast<int>((section == Name ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
        default: return {};
    }
}

Qt::ItemFlags FieldTreeModel::flags(const QModelIndex& index) const {
    if (!index.isValid())
        return Qt::NoItemFlags;
    return fieldAt(index) ? Qt::ItemIsEnabled | Qt::ItemIsSelectable : Qt::ItemIsEnabled;
}

} // namespace isoslider::widgets
