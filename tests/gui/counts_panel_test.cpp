// What the panel states of the surface, against what is counted on its mesh.

#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QtTest>

#include "tests/gui/cones.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/number_text.h"

namespace isoslider::test {
namespace {

class CountsPanelTest : public WindowTest {
protected:
    void openCones() {
        window_->openFile(qpath(writeCones(folder_)));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_EQ(session_->topology().state(), model::TopologyState::Ready);
    }
    /// Beside `name`, in the group of that object name; empty where it is not shown.
    QString fact(const char* group, const char* name) {
        const QString start = QString::fromUtf8(name) + QStringLiteral(": ");
        for (const auto* label : child<QWidget>(group)->findChildren<QLabel*>())
            if (!label->isHidden() && label->accessibleName().startsWith(start))
                return label->text();
        return {};
    }
    void slideTo(double isovalue) {
        session_->isovalue().request(isovalue);
        ASSERT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == isovalue; }));
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_TRUE(waitUntil(
            [&] { return fact("surfaceFacts", "Isovalue") == QString::fromStdString(model::exactText(isovalue)); }));
    }
};

TEST_F(CountsPanelTest, CountsWhatTheMeshHas) {
    openCones();
    for (const double isovalue : {1.5, 0.25, -0.5, -2.125}) {
        slideTo(isovalue);
        session_->checkMesh();
        ASSERT_TRUE(
            waitUntil([&] { return session_->certificate() && session_->certificate()->isovalue == isovalue; }));
        const auto& certificate = *session_->certificate();
        EXPECT_EQ(fact("surfaceCounts", "Pieces"), QString::number(certificate.report.components)) << isovalue;
        EXPECT_EQ(fact("surfaceCounts", "Euler number"), QString::number(certificate.report.euler)) << isovalue;
        EXPECT_EQ(fact("surfaceFacts", "Triangles").remove(QLatin1Char(',')),
                  QString::number(session_->frame()->stats.triangles));
        const double area =
            fact("surfaceMeasures", "Area").remove(QStringLiteral("≈ ")).split(QChar(QChar::Nbsp)).front().toDouble();
        EXPECT_NEAR(area / certificate.report.area, 1.0, 0.02) << isovalue;
    }
    EXPECT_EQ(fact("surfaceCounts", "Pieces"), QStringLiteral("1"));
    slideTo(1.5);
    EXPECT_EQ(fact("surfaceCounts", "Pieces"), QStringLiteral("3"));
    EXPECT_EQ(fact("surfaceCounts", "Tunnels"), QStringLiteral("0"));
}

TEST_F(CountsPanelTest, SaysWhatIsStillToCome) {
    const auto* hint = child<QLabel>("surfaceHint");
    EXPECT_EQ(hint->text(), QStringLiteral("No volume is open."));
    builder_->holds = true;
    openBall();
    EXPECT_TRUE(waitUntil([&] { return hint->text() == QLatin1String("Counted once the index is built."); }));
    EXPECT_TRUE(waitUntil([&] { return !fact("surfaceFacts", "Triangles").isEmpty(); }));
    EXPECT_TRUE(fact("surfaceCounts", "Pieces").isEmpty());
    builder_->holds = false;
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(waitUntil([&] { return !fact("surfaceCounts", "Pieces").isEmpty(); }));
    EXPECT_TRUE(hint->isHidden());
    session_->close();
    EXPECT_TRUE(waitUntil([&] { return hint->text() == QLatin1String("No volume is open."); }));
    EXPECT_TRUE(fact("surfaceCounts", "Pieces").isEmpty());
}

TEST_F(CountsPanelTest, StatesMeasuresWithTheirUnits) {
    openCones();
    const auto measure = [this](const char* name) {
        return fact("surfaceMeasures", name).replace(QChar(QChar::Nbsp), QLatin1Char(' '));
    };
    ASSERT_TRUE(waitUntil([&] { return !measure("Area").isEmpty(); })); // once the topology is there
    EXPECT_TRUE(measure("Area").endsWith(QStringLiteral(" units²"))) << measure("Area").toStdString();
    EXPECT_TRUE(measure("Volume above").endsWith(QStringLiteral(" units³")));
    EXPECT_TRUE(measure("Mean gradient").endsWith(QStringLiteral(" per unit")))
        << measure("Mean gradient").toStdString();
}

// Of the region above the isovalue, which a mesh need not enclose.
TEST_F(CountsPanelTest, TheVolumeAboveHasOneNameEverywhere) {
    openCones();
    auto* curve = window_->findChild<QAction*>(QStringLiteral("curve.volume"));
    ASSERT_NE(curve, nullptr);
    EXPECT_EQ(curve->text().remove(u'&'), QStringLiteral("Volume Above"));
    const auto* quantities = child<QComboBox>("findQuantity");
    EXPECT_GE(quantities->findText(QStringLiteral("Volume above")), 0);
    EXPECT_LT(quantities->findText(QStringLiteral("Enclosed"), Qt::MatchContains), 0);
}

TEST_F(CountsPanelTest, IsInFront) {
    openCones();
    // Tabs behind the first are not hidden, but lie elsewhere.
    EXPECT_FALSE(child<QWidget>("surfaceFacts")->visibleRegion().isEmpty());
    EXPECT_TRUE(child<QWidget>("levelsTable")->visibleRegion().isEmpty());
}

} // namespace
} // namespace isoslider::test
