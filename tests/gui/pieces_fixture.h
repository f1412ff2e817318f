#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <QAbstractItemModelTester>
#include <QAction>
#include <QDockWidget>
#include <QLabel>
#include <QMenu>
#include <QSlider>
#include <QSpinBox>
#include <QTableView>
#include <QTest>

#include "core/extract/pieces/surface_pieces.h"
#include "tests/gui/float_volume.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/slices/slice_model.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/panels/piece_table.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {

/// Three cones along x; the surface at 1.5 is three pieces, 9, 5 and 3 long or so.
inline std::filesystem::path writeSeparateCones(const TemporaryFolder& folder) {
    return writeFloats(folder, "cones.mha", {40, 20, 20}, [](int x, int y, int z) {
        float value = -30.0f;
        for (int cone = 0; cone < 3; ++cone)
            value = std::max(value, 6.0f - 1.5f * static_cast<float>(cone) -
                                        std::hypot(static_cast<float>(x) - 7.0f - 12.5f * static_cast<float>(cone),
                                                   static_cast<float>(y) - 10.0f, static_cast<float>(z) - 10.0f));
        return value;
    });
}

class PiecesTest : public WindowTest {
protected:
    void open() {
        window_->openFile(QString::fromStdString(writeSeparateCones(folder_).string()));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        slideTo(1.5);
    }
    void slideTo(double isovalue) {
        ASSERT_TRUE(session_->isovalue().request(isovalue));
        ASSERT_TRUE(waitUntil([&] { return session_->frame()->isovalue == isovalue; }));
    }
    void showPanel() {
        child<QDockWidget>("piecesDock")->raise();
        ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
        ASSERT_TRUE(waitUntil([this] { return table()->model()->rowCount() == 3; }));
    }
    QTableView* table() { return child<QTableView>("pieceTable"); }
    QSlider* size() { return child<QSlider>("pieceSize"); }
    QString count() { return child<widgets::ElidedLabel>("pieceCount")->fullText(); }
    model::ViewState& view() { return window_->viewportHost().viewState(); }
};

class PickTest : public PiecesTest {
protected:
    void SetUp() override {
        if (window_->viewportHost().viewport() == nullptr)
            GTEST_SKIP() << "no OpenGL 3.3 here";
        open();
        session_->isovalue().request(1.5);
        QTest::keyClick(window_.get(), Qt::Key_1); // along y: the cones stand side by side
        ASSERT_TRUE(waitUntilSettled());
    }
    widgets::ViewportWidget& viewport() { return *window_->viewportHost().viewport(); }
    /// Where the middle of a cone is seen.
    QPoint pixelOf(int cone) {
        const glm::dvec3 at(7.0 + 12.5 * cone, 10.0, 10.0);
        const auto& frame = *session_->frame();
        const double aspect = static_cast<double>(viewport().width()) / viewport().height();
        const auto& camera = viewport().camera();
        const glm::dvec4 clip = camera.projectionMatrix(aspect) * camera.viewMatrix() *
                                render::indexToCentredWorld(frame.geometry, frame.geometry) * glm::dvec4(at, 1.0);
        return {static_cast<int>((1.0 + clip.x / clip.w) / 2.0 * viewport().width()),
                static_cast<int>((1.0 - clip.y / clip.w) / 2.0 * viewport().height())};
    }
    void pick(QPoint point) {
        doubleClick(viewport(), Qt::LeftButton, {}, point);
        ASSERT_TRUE(waitUntil([this] { return session_->frame()->pieces != nullptr; }));
    }
    const model::PieceOptions& pieces() { return view().options().pieces; }
    const extract::Piece& piece(std::size_t place) { return session_->frame()->pieces->pieces()[place]; }
    QAction* action(const char* name) { return window_->actions().action(name); }
};

} // namespace isoslider::test
