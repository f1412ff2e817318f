#include "ui/widgets/opening/volume_dialog.h"

#include <algorithm>

#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QFontMetrics>
#include <QGridLayout>
#include <QGuiApplication>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QSlider>
#include <QSpinBox>
#include <QVBoxLayout>

#include "core/base/folders.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/widgets/opening/field_tree_model.h"
#include "ui/widgets/opening/field_tree_view.h"
#include "ui/widgets/opening/preview_pane.h"
#include "ui/widgets/panels/fact_texts.h"

namespace isoslider::widgets {
namespace {

constexpr int kFieldsWidth = 440;
constexpr int kFolderWidth = 300; // of it, for the longest value
constexpr int kLeastNumberWidth = 68;

/// "int16" and "i16" are one type.
bool isNameOf(ScalarType type, const std::string& name) {
    const std::string own(scalarTypeName(type));
    const std::string kind = own[0] == 'u' ? "uint" : own[0] == 'i' ? "int" : "float";
    return name.empty() || name == own || name == kind + own.substr(1);
}

std::uint64_t bytesOf(const GridDims& dims, ScalarType type) {
    return static_cast<std::uint64_t>(pointCount(dims)) * scalarTypeSizeBytes(type);
}

QString nativeText(const std::filesystem::path& path) {
    return QDir::toNativeSeparators(QString::fromStdU16String(path.u16string()));
}

std::vector<Fact> factsOf(const model::OpenModel& model, const model::VolumeChoice& choice) {
    const auto* preview = model.preview().preview();
    const GridDims& dims = choice.size();
    std::vector<Fact> facts;
    const QString folder = nativeText(model.path().parent_path());
    facts.push_back({VolumeDialog::tr("Folder"),
                     QFontMetrics(QGuiApplication::font()).elidedText(folder, Qt::ElideMiddle, kFolderWidth),
                     nativeText(model.path())});
    facts.push_back({VolumeDialog::tr("Format"), fromStd(choice.contents().format), {}});
    if (!titleOf(choice.field()).isEmpty()) // in full: the table may have no room for it
        facts.push_back({isFolder(model.path()) ? VolumeDialog::tr("Series") : VolumeDialog::tr("Field"),
                         titleOf(choice.field()), fromStd(choice.field().name)});
    if (!choice.field().problem.empty()) // which is stated beside
        return facts;
    facts.push_back({VolumeDialog::tr("Grid points"),
                     QStringLiteral("%1 = %2").arg(dimsText(dims), fromStd(model::groupedText(pointCount(dims)))),
                     {}});
    if (preview == nullptr) {
        facts.push_back({VolumeDialog::tr("In the file"), fromStd(choice.field().typeName), {}});
        return facts;
    }
    const auto& info = preview->info;
    if (!isNameOf(info.type, choice.field().typeName))
        facts.push_back({VolumeDialog::tr("In the file"), fromStd(choice.field().typeName), {}});
    facts.push_back({VolumeDialog::tr("Sample type"), typeText(info.type), {}});
    facts.push_back({VolumeDialog::tr("Sample data"), fromStd(model::bytesText(bytesOf(dims, info.type))),
                     VolumeDialog::tr("%1 bytes").arg(fromStd(model::groupedText(bytesOf(dims, info.type))))});
    auto place = placeFactsOf(info.geometry, info.lengthUnit, info.isPatientSpace);
    if (choice.hasSize())
        place.erase(place.begin()); // the spacing is the preview's
    std::move(place.begin(), place.end(), std::back_inserter(facts));
    for (const auto& note : info.notes)
        facts.push_back({VolumeDialog::tr("Note"), fromStd(note), {}});
    return facts;
}

QLabel* caption(const QString& text, QWidget* buddy, QWidget* parent) {
    auto* label = new QLabel(text, parent);
    label->setBuddy(buddy);
    return label;
}

} // namespace

VolumeDialog::VolumeDialog(std::unique_ptr<model::OpenModel> model, QWidget* parent)
    : QDialog(parent), model_(std::move(model)) {
    setObjectName(QStringLiteral("volumeDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle(isFolder(model_->path()) ? tr("Open Folder") : tr("Open Volume"));
    auto* left = makeLeft();
    pane_ = new PreviewPane(this);
    const auto frame =
        layOutFileDialog(this, QString::fromStdU16String(model_->path().filename().u16string()), left, pane_);
    open_ = frame.open;
    open_->setObjectName(QStringLiteral("volumeOpen"));
    previewsFirst_ = new QCheckBox(tr("&Preview every file before it is opened"), this);
    previewsFirst_->setObjectName(QStringLiteral("previewsFirst"));
    previewsFirst_->hide();
    connect(previewsFirst_, &QCheckBox::toggled, this, &VolumeDialog::previewsFirstToggled);
    frame.bottom->insertWidget(0, previewsFirst_);
    connect(open_, &QPushButton::clicked, this, [this] {
        if (!model_->canOpen())
            return;
        Q_EMIT openRequested(QString::fromStdU16String(model_->path().u16string()), model_->choice()->options());
        accept();
    });
    resize(1100, 640);
    subscription_ = model_->changed().observe([this] { showState(); });
    showState();
}

VolumeDialog::~VolumeDialog() = default;

void VolumeDialog::offerPreviewsFirst(bool isOn) {
    const QSignalBlocker blocker(previewsFirst_);
    previewsFirst_->setChecked(isOn);
    previewsFirst_->show();
}

QWidget* VolumeDialog::makeLeft() {
    const auto [area, page, rows] = makeScrollPage(this);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    area->setFixedWidth(kFieldsWidth);
    rows->setContentsMargins(0, 0, 6, 0);
    rows->setSpacing(8);
    makeFields(rows, page);
    makeChoices(rows, page);
    facts_ = new FactForm(page);
    facts_->setObjectName(QStringLiteral("volumeFacts"));
    rows->addWidget(facts_);
    rows->addStretch(1);
    return area;
}

void VolumeDialog::makeFields(QVBoxLayout* rows, QWidget* page) {
    const bool isSeries = isFolder(model_->path());
    fieldsHeading_ = new QLabel(isSeries ? tr("&Series in this folder") : tr("&Fields in this file"), page);
    fields_ = new FieldTreeView(isSeries ? tr("Series") : tr("Field"), page);
    fieldsHeading_->setBuddy(fields_);
    fields_->setObjectName(QStringLiteral("volumeFields"));
    fields_->setAccessibleName(isSeries ? tr("Series in this folder") : tr("Fields in this file"));
    rows->addWidget(fieldsHeading_);
    rows->addWidget(fields_);
    connect(fields_, &FieldTreeView::fieldChosen, this, [this](int field) {
        change([=](model::VolumeChoice& choice) { choice.setField(static_cast<std::size_t>(field)); });
    });
    connect(fields_, &FieldTreeView::fieldOpened, this, [this] { open_->click(); });
}

void VolumeDialog::makeChoices(QVBoxLayout* rows, QWidget* page) {
    choices_ = new QWidget(page);
    auto* grid = new QGridLayout(choices_);
    grid->setContentsMargins(0, 0, 0, 4);
    grid->setHorizontalSpacing(14);
    grid->setColumnStretch(1, 1);
    component_ = new QComboBox(choices_);
    component_->setObjectName(QStringLiteral("volumeComponent"));
    component_->setAccessibleName(tr("Component"));
    grid->addWidget(componentName_ = caption(tr("&Component"), component_, choices_), 0, 0);
    grid->addWidget(component_, 0, 1);
    connect(component_, &QComboBox::currentIndexChanged, this, [this](int index) {
        const int component = component_->itemData(index).toInt();
        change([component](model::VolumeChoice& choice) { choice.setComponent(component); });
    });
    frameRow_ = new QWidget(choices_);
    auto* frameLayout = new QHBoxLayout(frameRow_);
    frameLayout->setContentsMargins(0, 0, 0, 0);
    frameSlider_ = new QSlider(Qt::Horizontal, frameRow_);
    frameSlider_->setAccessibleName(tr("Frame"));
    frame_ = new QSpinBox(frameRow_);
    frame_->setObjectName(QStringLiteral("volumeFrame"));
    frame_->setAccessibleName(tr("Frame"));
    frameLayout->addWidget(frameSlider_, 1);
    frameLayout->addWidget(frame_);
    grid->addWidget(frameName_ = caption(tr("F&rame"), frame_, choices_), 1, 0);
    grid->addWidget(frameRow_, 1, 1);
    connect(frameSlider_, &QSlider::valueChanged, frame_, &QSpinBox::setValue);
    connect(frame_, &QSpinBox::valueChanged, this,
            [this](int frame) { change([frame](model::VolumeChoice& choice) { choice.setFrame(frame); }); });
    makeSizeRow(choices_);
    grid->addWidget(sizeName_, 2, 0);
    grid->addWidget(sizeRow_, 2, 1);
    rows->addWidget(choices_);
}

void VolumeDialog::makeSizeRow(QWidget* page) {
    for (std::size_t axis = 0; axis < size_.size(); ++axis) {
        auto* box = size_[axis] = new QSpinBox(page);
        box->setRange(2, static_cast<int>(kMaxDim));
        box->setKeyboardTracking(false);
        box->setMinimumWidth(kLeastNumberWidth); // that of the greatest number would not leave room for three
        connect(box, &QSpinBox::valueChanged, this, [this, axis](int count) {
            change([=](model::VolumeChoice& choice) {
                GridDims size = choice.size();
                size[axis] = count;
                choice.setSize(size);
            });
        });
    }
    sizeRow_ = makeAxisRow({size_[0], size_[1], size_[2]}, "volumeSize", tr("Grid points"), page);
    sizeName_ = caption(tr("Resample &to X, Y, Z"), size_[0], page);
    const QString tip = tr("The grid of the file is not uniform: so many grid points along x, y and z take its place");
    sizeName_->setToolTip(tip);
    sizeRow_->setToolTip(tip);
}

void VolumeDialog::change(const std::function<void(model::VolumeChoice&)>& function) {
    if (!isShowing_)
        model_->change(function);
}

void VolumeDialog::showState() {
    using State = model::OpenModel::State;
    const auto* choice = model_->choice();
    for (QWidget* widget : {static_cast<QWidget*>(fieldsHeading_), static_cast<QWidget*>(fields_)})
        widget->setVisible(choice != nullptr && choice->hasFields());
    choices_->setVisible(choice != nullptr && (choice->hasComponents() || choice->hasFrames() || choice->hasSize()));
    open_->setEnabled(model_->canOpen());
    if (choice != nullptr) {
        isShowing_ = true;
        showFields(*choice);
        showChoices(*choice);
        showFacts(*choice);
        isShowing_ = false;
    }
    if (model_->state() == State::Failed)
        pane_->showProblem(fromStd(model_->error().line()));
    else if (choice != nullptr && !choice->problem().empty())
        pane_->showProblem(fromStd(choice->problem()));
    else
        pane_->showPreview(model_->preview());
}

void VolumeDialog::showFields(const model::VolumeChoice& choice) {
    if (!fields_->hasContents())
        fields_->setContents(choice.contents());
    fields_->setField(choice.fieldIndex());
}

void VolumeDialog::showChoices(const model::VolumeChoice& choice) {
    for (QWidget* widget : {static_cast<QWidget*>(componentName_), static_cast<QWidget*>(component_)})
        widget->setVisible(choice.hasComponents());
    for (QWidget* widget : {static_cast<QWidget*>(frameName_), frameRow_})
        widget->setVisible(choice.hasFrames());
    for (QWidget* widget : {static_cast<QWidget*>(sizeName_), sizeRow_})
        widget->setVisible(choice.hasSize());
    QStringList names;
    for (const auto& name : choice.componentNames())
        names << fromStd(name);
    const qsizetype components = names.size();
    if (choice.field().hasMagnitude)
        names << tr("Magnitude");
    if (component_->count() != names.size() || component_->itemText(0) != names[0]) {
        component_->clear();
        for (int i = 0; i < names.size(); ++i)
            component_->addItem(names[i], i < components ? i : io::kMagnitude);
    }
    component_->setCurrentIndex(component_->findData(choice.component()));
    const int last =
        static_cast<int>(std::min<std::int64_t>(choice.field().frames - 1, std::numeric_limits<int>::max()));
    frameSlider_->setRange(0, last);
    frame_->setRange(0, last);
    frameName_->setText(tr("F&rame, 0 … %1").arg(last));
    frame_->setValue(static_cast<int>(choice.frame()));
    frameSlider_->setValue(frame_->value());
    for (std::size_t axis = 0; axis < size_.size(); ++axis)
        size_[axis]->setValue(static_cast<int>(choice.size()[axis]));
}

void VolumeDialog::showFacts(const model::VolumeChoice& choice) { facts_->setFacts(factsOf(*model_, choice)); }

} // namespace isoslider::widgets
