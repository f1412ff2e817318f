#pragma once

#include <cmath>

#include <QAbstractSpinBox>
#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QTableView>
#include <QTest>
#include <QTreeView>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/opening/preview_pane.h"

// What the tests of opening share.

namespace isoslider::test {

namespace fs = std::filesystem;

/// A ball of radius n/3, 0 outside to `top` inside, as samples of T.
template <class T>
std::vector<T> ballSamples(const GridDims& dims, double top) {
    std::vector<T> samples;
    for (std::int64_t z = 0; z < dims[2]; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y)
            for (std::int64_t x = 0; x < dims[0]; ++x) {
                const auto from = [](std::int64_t i, std::int64_t n) {
                    return static_cast<double>(i) / static_cast<double>(n - 1) - 0.5;
                };
                const double r = std::hypot(from(x, dims[0]), from(y, dims[1]), from(z, dims[2]));
                samples.push_back(static_cast<T>(top / (1.0 + std::exp((r - 0.33) * 24.0))));
            }
    return samples;
}

class OpenFlowTest : public WindowTest {
protected:
    QDialog* dialog(const char* name) {
        QDialog* found = nullptr;
        waitUntil([&] { return (found = window_->findChild<QDialog*>(QLatin1String(name))) != nullptr; });
        EXPECT_NE(found, nullptr) << name;
        return found;
    }
    bool waitForPreview(QDialog* dialog) {
        auto* open = dialog->findChild<QPushButton*>(dialog->objectName() == QStringLiteral("volumeDialog")
                                                         ? QStringLiteral("volumeOpen")
                                                         : QStringLiteral("rawOpen"));
        auto* progress = dialog->findChild<QProgressBar*>(QStringLiteral("previewProgress"));
        return waitUntil([&] { return open->isEnabled() && !progress->isVisible(); });
    }
    static QString status(QDialog* dialog) { return dialog->findChild<widgets::PreviewPane*>()->statusText(); }
    bool isGone(const char* dialog) {
        return waitUntil([&] { return window_->findChild<QDialog*>(QLatin1String(dialog)) == nullptr; });
    }
    bool waitForSurface() {
        return waitUntil([this] { return session_->frame() != nullptr && !session_->isLoading(); });
    }
    /// Nothing that a label states is cut off.
    static void expectLegible(const QDialog* dialog) {
        QTest::qWait(50); // the layout follows
        for (const auto* label : dialog->findChildren<QLabel*>()) {
            if (!label->isVisible() || label->text().isEmpty())
                continue;
            const int needed = label->wordWrap() ? label->heightForWidth(label->width()) : label->sizeHint().height();
            EXPECT_GE(label->height(), needed) << label->text().toStdString();
            if (!label->wordWrap()) {
                EXPECT_GE(label->width(), label->sizeHint().width()) << label->text().toStdString();
            }
        }
        for (const auto* widget : dialog->findChildren<QWidget*>()) {
            const auto shown = widget->visibleRegion().boundingRect();
            const bool isSimple = widget->findChildren<QWidget*>().size() <= 3 && widget->parentWidget() != nullptr;
            EXPECT_TRUE(!isSimple || shown.isEmpty() || shown.width() == widget->width())
                << widget->objectName().toStdString() << " (" << widget->metaObject()->className() << ")";
        }
    }
    /// Every control has a name for those who do not see it.
    static void expectNamed(const QDialog* dialog) {
        for (const auto* widget : dialog->findChildren<QWidget*>()) {
            const bool isControl = qobject_cast<const QAbstractSpinBox*>(widget) != nullptr ||
                                   qobject_cast<const QComboBox*>(widget) != nullptr ||
                                   qobject_cast<const QTableView*>(widget) != nullptr ||
                                   qobject_cast<const QTreeView*>(widget) != nullptr;
            bool hasBuddy = false;
            for (const auto* label : dialog->findChildren<QLabel*>())
                hasBuddy = hasBuddy || label->buddy() == widget;
            EXPECT_TRUE(!isControl || hasBuddy || !widget->accessibleName().isEmpty())
                << widget->objectName().toStdString();
        }
    }
};

inline io::VolumeField fieldOf(const char* name, const char* title, const GridDims& dims) {
    io::VolumeField field;
    field.name = name;
    field.title = title;
    field.dims = dims;
    field.typeName = "int16";
    return field;
}

/// Readers that find what they are told to; samples are a ball whose greatest value reports what was chosen.
class FakeReadersTest : public OpenFlowTest {
protected:
    FakeReadersTest() {
        volumes_.list = [this](const fs::path&, const io::ReadOptions&) -> Result<io::VolumeContents> {
            return contents_;
        };
        volumes_.open = [this](const fs::path& path,
                               const io::ReadOptions& options) -> Result<std::unique_ptr<io::VolumeSource>> {
            const bool mustChoose =
                contents_.needsChoice() && options.field.empty() && !options.component && !options.frame;
            if (mustChoose)
                return makeError(ErrorCode::InvalidArgument, "holds several volumes; choose one", path.string());
            const io::VolumeField* field = fieldNamed(options.field);
            if (field == nullptr)
                return makeError(ErrorCode::InvalidArgument, "there is no such field", path.string());
            GridGeometry geometry;
            geometry.dims = options.resampleDims[0] > 0 ? options.resampleDims : contents_.fields[0].dims;
            const double top = 1000.0 + (options.field == "b" ? 500.0 : 0.0) + 100.0 * options.component.value_or(0) +
                               10.0 * static_cast<double>(options.frame.value_or(0));
            io::VolumeInfo info;
            info.format = contents_.format;
            info.fieldName = field->name;
            info.fieldTitle = field->title;
            info.lengthUnit = "mm";
            return io::makeMemorySource(std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<std::int16_t>(
                                            geometry, ScalarType::I16, ballSamples<std::int16_t>(geometry.dims, top))),
                                        std::move(info));
        };
        volumes_.read = [this, read = volumes_.read](io::VolumeSource& source, const fs::path& path,
                                                     const JobControl& job) {
            while (isHeld_ && !job.isStopRequested())
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            return job.isStopRequested() ? cancelledError() : read(source, path, job);
        };
        contents_.format = "DICOM";
        contents_.fields = {fieldOf("a", "3: T1 MPRAGE sagittal", {24, 20, 28}),
                            fieldOf("b", "5: T2 FLAIR axial", {24, 20, 28})};
        makeWindow();
    }
    ~FakeReadersTest() override {
        window_.reset();
        session_.reset();
    }
    /// The first one, if none is named.
    const io::VolumeField* fieldNamed(const std::string& name) const {
        for (const auto& field : contents_.fields)
            if (name.empty() || field.name == name)
                return &field;
        return nullptr;
    }
    io::VolumeContents contents_;
    std::atomic<bool> isHeld_{false};
};

} // namespace isoslider::test
