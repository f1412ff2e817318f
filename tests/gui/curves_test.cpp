// Curves over the histogram.
#include <QAction>
#include <QLabel>
#include <QMenu>
#include <QTest>
#include <QTimer>
#include <QToolButton>

#include "tests/gui/topology_fixture.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::test {
namespace {

class CurvesTest : public TopologyTest {
protected:
    /// Opens the menu with the mouse and clicks the entry.
    void toggle(const char* name) {
        auto* button = child<QToolButton>("curvesButton");
        QAction* action = actionOf(name);
        // The menu has an event loop.
        QTimer::singleShot(0, button->menu(), [button, action] {
            ASSERT_TRUE(waitUntil([&] { return button->menu()->isVisible(); }, std::chrono::seconds(5)));
            QTest::mouseClick(button->menu(), Qt::LeftButton, {}, button->menu()->actionGeometry(action).center());
            button->menu()->close();
        });
        QTest::mouseClick(button, Qt::LeftButton);
        ASSERT_TRUE(waitUntil([button] { return !button->menu()->isVisible(); }));
    }
    QAction* actionOf(const char* name) {
        auto* action = window_->findChild<QAction*>(QStringLiteral("curve.") + QLatin1String(name));
        EXPECT_NE(action, nullptr);
        return action;
    }
    std::string legend() {
        auto* label = child<QLabel>("curveLegend");
        QString text = label->isVisible() ? label->text() : QString();
        text.replace(QStringLiteral("&nbsp;"), QStringLiteral(" ")).replace(QChar(QChar::Nbsp), QLatin1Char(' '));
        return text.toStdString();
    }
};

TEST_F(CurvesTest, AreDrawnWhereTheyAreWantedAndKnown) {
    EXPECT_EQ(legend(), "");
    EXPECT_TRUE(actionOf("pieces")->isEnabled());
    toggle("pieces");
    isovalue().request(1.5);
    EXPECT_NE(legend().find("pieces: 3"), std::string::npos) << legend();
    isovalue().request(5.0);
    EXPECT_NE(legend().find("pieces: 1"), std::string::npos) << legend();
    EXPECT_EQ(settings_->list("histogram/curves"), QStringList{QStringLiteral("pieces")});
    keepPicture(*window_, "topology_curves");
    toggle("pieces");
    EXPECT_EQ(legend(), "");
    EXPECT_TRUE(settings_->list("histogram/curves").isEmpty());
}

TEST_F(CurvesTest, OfMeasuresAreThereOnceTheyAreKnown) {
    topology().setFailed("no measures");
    for (const char* name : {"pieces", "area", "gradient"}) {
        EXPECT_FALSE(actionOf(name)->isEnabled()) << name;
        EXPECT_EQ(actionOf(name)->toolTip(), QStringLiteral("Not known for this volume"));
    }
    topology().setContent(model::TopologyModel::contentOf(std::make_shared<QuietSummary>()).value());
    EXPECT_FALSE(actionOf("pieces")->isEnabled());
    toggle("area");
    toggle("triangles");
    isovalue().request(-10.0);
    EXPECT_NE(legend().find("area: ≈ 20 units²"), std::string::npos) << legend();
    EXPECT_NE(legend().find("triangles (log): 500,001"), std::string::npos) << legend();
    topology().setFailed("gone");
    EXPECT_EQ(legend(), "") << "what is chosen is not shown of nothing";
}

// Neither what is drawn nor the tag of the handle.
TEST_F(CurvesTest, TheLegendCoversNothing) {
    const auto& plot = window_->isovaluePanel().plot();
    auto* label = child<QLabel>("curveLegend");
    const int before = plot.axisRect()->height();
    toggle("pieces");
    toggle("tunnels");
    QTest::qWait(50);
    ASSERT_TRUE(label->isVisible());
    const int tag = label->fontMetrics().height();
    EXPECT_LE(label->geometry().bottom(), plot.axisRect()->top() - tag);
    EXPECT_TRUE(plot.rect().contains(label->geometry()));
    keepPicture(*window_, "curves_legend");
    window_->resize(500, 900); // in lines
    QTest::qWait(100);
    EXPECT_LE(label->geometry().bottom(), plot.axisRect()->top() - tag);
    EXPECT_TRUE(plot.rect().contains(label->geometry()));
    keepPicture(*window_, "curves_legend_narrow");
    window_->resize(1400, 900);
    toggle("pieces");
    toggle("tunnels");
    QTest::qWait(50);
    EXPECT_EQ(plot.axisRect()->height(), before) << "its room is the plot's again";
}

TEST_F(CurvesTest, ChoicesAreKept) {
    toggle("tunnels");
    makeWindow();
    openCones();
    EXPECT_TRUE(actionOf("tunnels")->isChecked());
    EXPECT_NE(legend().find("tunnels: "), std::string::npos) << legend();
}

} // namespace
} // namespace isoslider::test
