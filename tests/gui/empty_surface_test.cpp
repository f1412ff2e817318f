// Isovalues without a surface: what is exported and checked there.
#include <QLabel>
#include <QTest>

#include "core/mesh/mesh_checks.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

class EmptySurfaceTest : public WindowTest {
protected:
    EmptySurfaceTest() {
        openBall();
        slideTo(session_->dataset()->min); // no sample is below
    }
    void slideTo(double isovalue) {
        session_->isovalue().request(isovalue);
        EXPECT_TRUE(waitUntil([&] { return session_->frame()->isovalue == isovalue && session_->isSettled(); }));
    }
    QString textOf(const char* fact) {
        const QString start = QLatin1String(fact) + QStringLiteral(": ");
        for (const auto* label : child<QWidget>("certificateForm")->findChildren<QLabel*>())
            if (!label->isHidden() && label->accessibleName().startsWith(start))
                return label->text();
        return {};
    }
};

TEST_F(EmptySurfaceTest, AnExportStatesThatTheMeshIsEmpty) {
    ASSERT_EQ(session_->frame()->stats.triangles, 0u);
    dialogs_.answers = {qpath(folder_ / "none.ply"), qpath(folder_ / "some.ply")};
    trigger("mesh.export");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible() && session_->isSettled(); }));
    const QString said = window_->messageBar().text();
    EXPECT_TRUE(said.startsWith(QStringLiteral("The exported mesh is empty"))) << said.toStdString();
    EXPECT_TRUE(said.contains(QStringLiteral("there is no surface at isovalue"))) << said.toStdString();
    EXPECT_TRUE(said.contains(QStringLiteral("none.ply")));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "none.ply")) << "what was asked for is written all the same";
    keepPicture(*window_, "empty_export");
    slideTo(-5.0);
    trigger("mesh.export");
    EXPECT_TRUE(waitUntil([this] { return window_->messageBar().text().startsWith(QStringLiteral("Mesh exported")); }));
}

TEST_F(EmptySurfaceTest, ACheckStatesThatThereWasNothingToCheck) {
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([this] { return session_->certificate() && session_->isSettled(); }));
    EXPECT_EQ(textOf("Sound"), QStringLiteral("– (no surface)"));
    EXPECT_EQ(textOf("Surface"), QStringLiteral("none at this isovalue"));
    bool isStated = false;
    for (const auto* label : window_->findChildren<QLabel*>())
        isStated =
            isStated || (label->isVisible() && label->text().startsWith(QStringLiteral("There is no surface at")));
    EXPECT_TRUE(isStated);
    keepPicture(*window_, "empty_check");
    slideTo(-5.0);
    trigger("mesh.check");
    EXPECT_TRUE(waitUntil([this] { return textOf("Surface") == QStringLiteral("closed"); }));
    EXPECT_TRUE(textOf("Sound").contains(QStringLiteral("yes")));
}

} // namespace
} // namespace isoslider::test
