#include <cmath>
#include <set>

#include <QAbstractItemModelTester>
#include <QAction>
#include <QDialog>
#include <QDockWidget>
#include <QLabel>
#include <QMenu>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QTableView>
#include <QTest>
#include <QToolButton>

#include "core/mesh/mesh_checks.h"
#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/gui/window_fixture.h"
#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/session/saved_session.h"
#include "ui/widgets/opening/start_page.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"

namespace isoslider::test {
namespace {

using MainWindowTest = WindowTest;

TEST_F(MainWindowTest, BeginsWithTheStartPage) {
    EXPECT_TRUE(window_->viewportHost().startPage().isVisible());
    for (const char* id : {"mesh.check", "mesh.export", "isovalue.play", "file.close"})
        EXPECT_FALSE(window_->actions().action(id)->isEnabled()) << id;
}

TEST_F(MainWindowTest, OpensAFileFromTheStartPage) {
    dialogs_.answers.push_back(qpath(writeBall(folder_, "ball.mha", 16)));
    QTest::mouseClick(child<QPushButton>("start.file.open"), Qt::LeftButton);
    auto* open = child<QPushButton>("volumeOpen");
    ASSERT_TRUE(waitUntil([&] { return open->isEnabled(); }));
    QTest::mouseClick(open, Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_FALSE(window_->viewportHost().startPage().isVisible());
    EXPECT_EQ(window_->windowTitle(), QStringLiteral("ball.mha – ISOSLIDER"));
    EXPECT_EQ(settings_->list("files/recent").size(), 1);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_EQ(session_->indexState(), model::IndexState::Ready);
}

TEST_F(MainWindowTest, RetriangulatedCellsAreADiagnosticWithALegend) {
    if (window_->viewportHost().viewport() == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    openBall();
    auto* legend = child<QLabel>("legend");
    EXPECT_FALSE(window_->actions().action("view.changed")->isChecked());
    EXPECT_FALSE(legend->isVisible());
    trigger("view.changed");
    EXPECT_TRUE(legend->isVisible());
    EXPECT_TRUE(legend->text().contains(QStringLiteral("retriangulated"))) << legend->text().toStdString();
    trigger("view.changed");
    EXPECT_FALSE(legend->isVisible());
}

TEST_F(MainWindowTest, OpensADroppedFile) {
    drop(writeBall(folder_, "ball.mha", 16));
    EXPECT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_EQ(window_->findChild<QDialog*>(), nullptr) << "with nothing to choose nothing is asked";
}

TEST_F(MainWindowTest, B109_ABadFileShowsTheMessageBarAndKeepsTheOldSurface) {
    openBall();
    const auto frame = session_->frame();
    const auto bad = folder_.write("bad.mha", "ObjectType = Image\nNDims = 3\nDimSize = 4 4 bananas\n");
    window_->openFile(qpath(bad));
    ASSERT_TRUE(waitUntil([&] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("bad.mha")));
    EXPECT_EQ(session_->frame(), frame);
    session_->isovalue().request(-5.0);
    EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -5.0; }));
    QTest::mouseClick(window_->messageBar().findChild<QToolButton*>(QStringLiteral("messageBarClose")), Qt::LeftButton);
    EXPECT_FALSE(window_->messageBar().isVisible());
}

TEST_F(MainWindowTest, AMissingFileIsToldOnTheStartPage) {
    window_->openFile(qpath(folder_ / "nowhere.mha"));
    ASSERT_TRUE(waitUntil([&] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(window_->viewportHost().startPage().isVisible());
}

TEST_F(MainWindowTest, ASecondOpenUsesTheIndexAtOnce) {
    openBall();
    makeWindow();
    window_->openFile(qpath(folder_ / "ball.mha"));
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    EXPECT_TRUE(session_->frame()->isFromIndex);
    for (const auto& job : session_->jobs().entries())
        EXPECT_FALSE(job.title.starts_with("Build index")) << job.title;
}

TEST_F(MainWindowTest, OpensAnIndexWithoutItsVolume) {
    openBall();
    // An isovalue that is asked for: the first one improves once the topology is known, sooner or later.
    const auto slide = [this] {
        session_->isovalue().request(-5.0);
        return waitUntil([&] { return session_->isovalue().displayed() == -5.0; });
    };
    ASSERT_TRUE(slide());
    const auto index = session_->dataset()->indexPath;
    const auto triangles = session_->frame()->stats.triangles;
    trigger("file.close");
    EXPECT_TRUE(window_->viewportHost().startPage().isVisible());
    std::filesystem::remove(folder_ / "ball.mha");
    window_->openFile(qpath(index));
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    ASSERT_TRUE(slide());
    EXPECT_EQ(session_->frame()->stats.triangles, triangles);
}

TEST_F(MainWindowTest, TheLevelsPanelIsFilledFromTheIndex) {
    auto* levels = child<QTableView>("levelsTable");
    auto* walk = child<QTableView>("walkTable");
    QAbstractItemModelTester levelsTester(levels->model(), QAbstractItemModelTester::FailureReportingMode::Warning);
    QAbstractItemModelTester walkTester(walk->model(), QAbstractItemModelTester::FailureReportingMode::Warning);
    builder_->kind = index::IndexKind::Edges;
    openBall();
    const auto inLevels = static_cast<int>(session_->dataset()->index->levels.size());
    ASSERT_EQ(levels->model()->rowCount(), inLevels + 2);
    EXPECT_EQ(levels->model()->index(inLevels, 0).data().toString(), QStringLiteral("Samples"));
    EXPECT_EQ(levels->model()->index(inLevels + 1, 0).data().toString(), QStringLiteral("All"));
    session_->isovalue().request(-3.0);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(
        waitUntil([&] { return walk->model()->rowCount() == static_cast<int>(session_->frame()->stats.walk.size()); }));
}

TEST_F(MainWindowTest, AnIndexOfMetacellsIsShownInTheSameTerms) {
    const auto source = io::openVolume(writeBall(folder_, "ball.mha", 40));
    ASSERT_TRUE(source.isOk());
    preprocess::BuildOptions options;
    options.kind = index::IndexKind::Metacells;
    ASSERT_TRUE(preprocess::buildIndex(*source.value(), folder_ / "ball.isx", options).isOk());
    window_->openFile(qpath(folder_ / "ball.isx"));
    ASSERT_TRUE(waitUntil([&] { return session_->frame() != nullptr; }));
    const auto* levels = child<QTableView>("levelsTable")->model();
    const int rows = static_cast<int>(session_->dataset()->index->levels.size());
    ASSERT_EQ(levels->rowCount(), rows + 2);
    EXPECT_EQ(levels->index(rows, 0).data().toString(), QStringLiteral("Samples"));
    EXPECT_EQ(levels->index(0, 2).data(), levels->index(0, 3).data()) << "a brick has one entry";
    const auto triangles = session_->frame()->stats.triangles;
    session_->isovalue().request(session_->isovalue().requested() + 1.0);
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_NE(session_->frame()->stats.triangles, triangles);
    EXPECT_GT(session_->frame()->stats.bricksRead, 0u);
}

TEST_F(MainWindowTest, ChecksTheMesh) {
    openBall();
    session_->isovalue().request(-6.0);
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([&] { return session_->certificate().has_value(); }));
    EXPECT_TRUE(session_->certificate()->report.isManifold);
    EXPECT_TRUE(session_->certificate()->report.isClosed);
    EXPECT_EQ(session_->certificate()->report.euler, 2);
    EXPECT_TRUE(child<QDockWidget>("meshDock")->isVisible());
    EXPECT_EQ(child<QPushButton>("checkMeshButton")->isEnabled(), true);
}

/// The value beside a name in the Mesh panel; null when it is not shown.
QLabel* factOf(const QWidget& form, const char* name) {
    for (auto* label : form.findChildren<QLabel*>())
        if (label->accessibleName().startsWith(QString::fromUtf8(name) + QStringLiteral(": ")) &&
            label->isVisibleTo(&form))
            return label;
    return nullptr;
}

/// Its text, with plain spaces.
std::string factTextOf(const QWidget& form, const char* name) {
    const auto* label = factOf(form, name);
    return label == nullptr ? "not shown" : label->text().replace(QChar(QChar::Nbsp), QLatin1Char(' ')).toStdString();
}

TEST_F(MainWindowTest, StatesMeanAndStandardDeviationOfTheSamples) {
    openBall();
    const auto* form = child<QWidget>("datasetForm");
    // Of distances from the middle of a cube, by another way than the program's.
    double sum = 0.0, squares = 0.0;
    for (int z = 0; z < 24; ++z)
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x) {
                const double square = (x - 11.5) * (x - 11.5) + (y - 11.5) * (y - 11.5) + (z - 11.5) * (z - 11.5);
                sum -= std::sqrt(square);
                squares += square;
            }
    const double mean = sum / (24 * 24 * 24), deviation = std::sqrt(squares / (24 * 24 * 24) - mean * mean);
    EXPECT_EQ(factTextOf(*form, "Mean ± deviation"), model::spreadText({mean, deviation, true}));
    const auto index = session_->dataset()->indexPath;
    window_->openFile(qpath(index));
    ASSERT_TRUE(waitUntil([&] { return session_->dataset()->path == index; }));
    EXPECT_EQ(factTextOf(*form, "Mean ± deviation"), model::spreadText({mean, deviation, true})) << "of the index";
}

TEST_F(MainWindowTest, ShowsTheCertificateOfTheSurface) {
    openBall();
    const auto* form = child<QWidget>("certificateForm");
    EXPECT_EQ(factOf(*form, "Surface"), nullptr); // not before it is asked for
    session_->isovalue().request(-6.0);
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([&] { return factOf(*form, "Surface") != nullptr; }));
    EXPECT_EQ(factTextOf(*form, "Surface"), "closed");
    EXPECT_TRUE(factOf(*form, "Sound")->text().contains(QStringLiteral("yes")));
    EXPECT_EQ(factTextOf(*form, "Euler number"), "2");
    EXPECT_EQ(factTextOf(*form, "Genus"), "0");
    EXPECT_EQ(factTextOf(*form, "Inner vertices"), "0");
    EXPECT_TRUE(factOf(*form, "Area")->text().endsWith(QChar(QChar::Nbsp) + QStringLiteral("units²")));
    EXPECT_TRUE(factOf(*form, "Enclosed volume")->text().endsWith(QChar(QChar::Nbsp) + QStringLiteral("units³")));
    session_->isovalue().request(-14.0); // cut by every face of the box
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([&] { return factOf(*form, "Surface")->text() != QStringLiteral("closed"); }));
    EXPECT_EQ(factTextOf(*form, "Surface"),
              "open at x0 (1 loop), x1 (1 loop), y0 (1 loop), y1 (1 loop), z0 (1 loop), z1 (1 loop)");
    EXPECT_EQ(factTextOf(*form, "Enclosed volume"), "– (open)");
    EXPECT_EQ(factTextOf(*form, "Boundary loops"), "6");
    EXPECT_EQ(factTextOf(*form, "Nudged vertices"), "0");
    session_->isovalue().request(session_->dataset()->max); // a tie at the eight grid points in the middle
    trigger("mesh.check");
    ASSERT_TRUE(waitUntil([&] { return factTextOf(*form, "Surface") == "closed"; }));
    EXPECT_EQ(factTextOf(*form, "Nudged vertices"), "24, by at most 0.000488 cells (0.000488 units)");
    EXPECT_EQ(factTextOf(*form, "Degenerate triangles"), "0");
}

TEST_F(MainWindowTest, CutsNothingOffTheCertificate) {
    openBall();
    session_->isovalue().request(-14.0);
    trigger("mesh.check");
    const auto* form = child<QWidget>("certificateForm");
    ASSERT_TRUE(waitUntil([&] { return factOf(*form, "Surface") != nullptr; }));
    QTest::qWait(50); // the layout follows
    const auto* panel = form->parentWidget();
    const auto* counts = child<QWidget>("countsForm");
    const int left = factOf(*counts, "Isovalue")->mapTo(panel, QPoint()).x();
    for (const auto* label : form->findChildren<QLabel*>()) {
        if (!label->isVisibleTo(form))
            continue;
        const int width = label->wordWrap() ? label->width() : label->sizeHint().width();
        EXPECT_GE(label->width(), width) << label->text().toStdString();
        EXPECT_GE(label->height(),
                  label->wordWrap() ? label->heightForWidth(label->width()) : label->sizeHint().height())
            << label->text().toStdString();
        EXPECT_TRUE(form->rect().contains(label->geometry())) << label->text().toStdString();
        if (!label->accessibleName().isEmpty()) { // a value, not a name
            EXPECT_EQ(label->mapTo(panel, QPoint()).x(), left) << label->text().toStdString();
        }
    }
}

TEST_F(MainWindowTest, ExportsTheCertificateWithTheMesh) {
    openBall();
    session_->isovalue().request(-6.0);
    ASSERT_TRUE(waitUntilSettled());
    dialogs_.answers.push_back(qpath(folder_ / "a.ply"));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntilSettled());
    const auto bytes = readText(folder_ / "a.ply");
    const auto triangles = "comment triangles: " + std::to_string(session_->frame()->stats.triangles) + "\n";
    for (const auto& line : {std::string("comment source: ball.mha\n"), std::string("comment isovalue: -6\n"),
                             triangles, std::string("comment boundary: closed\n"), std::string("comment valid: yes\n")})
        EXPECT_NE(bytes.find(line), std::string::npos) << line;
    // One check for the file and the panel.
    EXPECT_EQ(factTextOf(*child<QWidget>("certificateForm"), "Surface"), "closed");
}

TEST_F(MainWindowTest, ExportsFromAnIndexInTheNameOfItsVolume) {
    openBall();
    const auto index = session_->dataset()->indexPath;
    trigger("file.close");
    window_->openFile(qpath(index));
    ASSERT_TRUE(waitUntilSettled());
    ASSERT_NE(session_->frame(), nullptr);
    dialogs_.answers.push_back(qpath(folder_ / "a.obj"));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_NE(readText(folder_ / "a.obj").find("# source: ball.mha\n"), std::string::npos);
}

TEST_F(MainWindowTest, ExportsTheMeshInEveryFormat) {
    openBall();
    for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.om"}) {
        dialogs_.answers.push_back(qpath(folder_ / name));
        trigger("mesh.export");
        ASSERT_TRUE(waitUntilSettled());
        const auto report = mesh::checkMeshFile(folder_ / name);
        ASSERT_TRUE(report.isOk()) << name << ' ' << report.error().line();
        EXPECT_EQ(report.value().triangles, session_->frame()->stats.triangles) << name;
    }
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("a.om")));
}

TEST_F(MainWindowTest, AnExportIsOfTheVolumeItWasAskedForOn) {
    openBall();
    const auto openAnother = [this] {
        window_->openFile(qpath(writeBall(folder_, "other.mha", 16)));
        ASSERT_TRUE(waitUntil([this] { return session_->dataset()->name == "other.mha"; }));
        ASSERT_TRUE(waitUntilSettled());
    };
    dialogs_.meanwhile = openAnother;
    dialogs_.answers.push_back(qpath(folder_ / "ball.ply"));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "ball.ply"));
    EXPECT_TRUE(window_->messageBar().isVisible());
    EXPECT_TRUE(window_->messageBar().text().contains(QStringLiteral("not exported")));
}

TEST_F(MainWindowTest, ASessionIsOfTheVolumeItWasAskedForOn) {
    openBall();
    dialogs_.meanwhile = [this] {
        window_->openFile(qpath(writeBall(folder_, "other.mha", 16)));
        ASSERT_TRUE(waitUntil([this] { return session_->dataset()->name == "other.mha"; }));
    };
    dialogs_.answers.push_back(qpath(folder_ / "ball.isosession"));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return std::filesystem::exists(folder_ / "ball.isosession"); }));
    EXPECT_EQ(model::readSession(folder_ / "ball.isosession").value().session.volume.filename(), "ball.mha");
}

TEST_F(MainWindowTest, AnExportThatFailsIsTold) {
    openBall();
    dialogs_.answers.push_back(qpath(folder_ / "no" / "such" / "folder.ply"));
    trigger("mesh.export");
    ASSERT_TRUE(waitUntilSettled());
    EXPECT_TRUE(window_->messageBar().isVisible());
    EXPECT_EQ(session_->jobs().entries().back().state, model::JobState::Failed);
}

TEST_F(MainWindowTest, ABuildCanBeCancelledAndStartedAgain) {
    builder_->holds = true;
    openBall();
    ASSERT_TRUE(waitUntil([&] { return session_->indexState() == model::IndexState::Building; }));
    child<QDockWidget>("jobsDock")->raise();
    QToolButton* cancel = nullptr;
    ASSERT_TRUE(waitUntil([&] {
        for (auto* button : window_->findChildren<QToolButton*>(QStringLiteral("cancelJobButton")))
            if (button->isVisible())
                cancel = button;
        return cancel != nullptr;
    }));
    QTest::mouseClick(cancel, Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return session_->indexState() == model::IndexState::Cancelled; }));
    session_->isovalue().request(-4.0);
    EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -4.0; }));
    builder_->holds = false;
    trigger("index.build");
    EXPECT_TRUE(waitUntil([&] { return session_->indexState() == model::IndexState::Ready; }));
}

TEST_F(MainWindowTest, TheStatusBarShowsWhatIsWorkedOn) {
    openBall();
    model::JobModel& jobs = session_->jobs();
    auto* status = child<QWidget>("jobStatus");
    auto* text = status->findChild<QToolButton*>();
    auto* bar = status->findChild<QProgressBar*>();
    EXPECT_FALSE(status->isVisible());
    const auto build = jobs.add("Build index of black & white.mha");
    jobs.setProgress(build, 0.1, "sorting", 100.0);
    EXPECT_FALSE(status->isVisible()) << "it may be over at once";
    jobs.setProgress(build, 0.43, "sorting", 900.0);
    EXPECT_TRUE(status->isVisible());
    EXPECT_EQ(text->text(), QStringLiteral("Build index of black && white.mha"));
    EXPECT_TRUE(text->toolTip().contains(QStringLiteral("Sorting · 43 %")));
    EXPECT_EQ(bar->value(), 430);
    EXPECT_GT(bar->mapTo(window_.get(), QPoint(bar->width(), 0)).x(), window_->width() - 30);
    const auto other = jobs.add("Export " + std::string(300, 'x') + ".stl");
    jobs.setProgress(other, 0.2, "writing", 2000.0);
    EXPECT_TRUE(text->text().startsWith(QStringLiteral("Export xxx")));
    EXPECT_TRUE(text->text().endsWith(QStringLiteral(" and 1 more")));
    EXPECT_GT(text->mapTo(window_.get(), QPoint()).x(), window_->width() / 2) << "names are shortened";
    auto* dock = child<QDockWidget>("jobsDock");
    dock->close();
    QTest::mouseClick(text, Qt::LeftButton);
    EXPECT_TRUE(dock->isVisible());
    jobs.finish(other, model::JobState::Finished, "", 3000.0);
    EXPECT_EQ(bar->value(), 430);
    jobs.finish(build, model::JobState::Cancelled, "", 3000.0);
    EXPECT_FALSE(status->isVisible());
}

TEST_F(MainWindowTest, B108_ClosingTheWindowDuringABuildIsSafe) {
    builder_->holds = true;
    openBall();
    window_->close();
    window_.reset();
    session_.reset();
    QTest::qWait(20);
}

TEST_F(MainWindowTest, PanelsCloseAndComeBack) {
    for (const char* name : {"datasetDock", "isovalueDock", "levelsDock", "meshDock", "jobsDock"}) {
        auto* dock = child<QDockWidget>(name);
        dock->close();
        EXPECT_TRUE(dock->isHidden()) << name;
        dock->toggleViewAction()->trigger();
        EXPECT_FALSE(dock->isHidden()) << name;
    }
    child<QDockWidget>("levelsDock")->setFloating(true);
    child<QDockWidget>("datasetDock")->close();
    trigger("view.resetLayout");
    EXPECT_FALSE(child<QDockWidget>("levelsDock")->isFloating());
    EXPECT_TRUE(child<QDockWidget>("datasetDock")->isVisible());
}

TEST_F(MainWindowTest, TheLayoutIsRestored) {
    child<QDockWidget>("levelsDock")->close();
    window_->close();
    makeWindow();
    EXPECT_FALSE(child<QDockWidget>("levelsDock")->isHidden());
    window_->restoreLayout();
    EXPECT_TRUE(child<QDockWidget>("levelsDock")->isHidden());
}

TEST_F(MainWindowTest, NoTwoActionsShareAShortcut) {
    std::set<QString> seen;
    for (const auto& section : window_->actions().sections())
        for (const auto* action : section.actions)
            for (const auto& keys : action->shortcuts())
                EXPECT_TRUE(seen.insert(keys.toString()).second) << keys.toString().toStdString();
}

TEST_F(MainWindowTest, EveryActionHasATextAndATip) {
    for (const auto& section : window_->actions().sections())
        for (const auto* action : section.actions) {
            EXPECT_FALSE(action->text().isEmpty()) << action->objectName().toStdString();
            EXPECT_FALSE(action->statusTip().isEmpty()) << action->objectName().toStdString();
        }
}

TEST_F(MainWindowTest, HelpOpensWithoutBlocking) {
    trigger("help.shortcuts");
    trigger("help.about");
    auto* sheet = child<QDialog>("shortcutSheet");
    EXPECT_TRUE(sheet->isVisible());
    const auto* scroll = sheet->findChild<QScrollArea*>();
    ASSERT_NE(scroll, nullptr);
    QTest::qWait(50);
    EXPECT_LE(scroll->widget()->width(), scroll->viewport()->width()) << "nothing is cut off";
    keepPicture(*sheet, "shortcut_sheet");
    EXPECT_TRUE(child<QDialog>("aboutDialog")->isVisible());
}

TEST_F(MainWindowTest, KeysAndMouseMoveTheCamera) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    openBall();
    viewport->setFocus();
    QTest::keyClick(viewport, Qt::Key_7);
    EXPECT_NEAR(viewport->camera().backward().z, 1.0, 1e-9);
    QTest::keyClick(viewport, Qt::Key_1, Qt::ControlModifier);
    EXPECT_NEAR(viewport->camera().backward().y, 1.0, 1e-9);
    QTest::keyClick(viewport, Qt::Key_5);
    EXPECT_FALSE(viewport->camera().isPerspective());
    const auto before = viewport->camera().backward();
    QTest::mousePress(viewport, Qt::LeftButton, {}, QPoint(200, 200));
    QMouseEvent move(QEvent::MouseMove, QPointF(260, 220), viewport->mapToGlobal(QPointF(260, 220)), Qt::NoButton,
                     Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(viewport, &move);
    QTest::mouseRelease(viewport, Qt::LeftButton, {}, QPoint(260, 220));
    EXPECT_GT(glm::length(viewport->camera().backward() - before), 0.05);
    QTest::keyClick(viewport, Qt::Key_R);
    EXPECT_EQ(viewport->camera().target(), glm::dvec3(0.0));
}

TEST_F(MainWindowTest, CtrlAndShiftWithKeysMoveTheCamera) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    openBall();
    QTest::mouseClick(viewport, Qt::LeftButton);
    ASSERT_TRUE(viewport->hasFocus());
    QTest::keyClick(window_.get(), Qt::Key_1);
    const model::Camera& camera = viewport->camera();
    const double isovalue = session_->isovalue().requested();
    const glm::dvec3 before = camera.backward();
    QTest::keyClick(viewport, Qt::Key_Right, Qt::ControlModifier);
    EXPECT_LT(camera.backward().x, before.x - 0.1) << "the scene goes to the right";
    QTest::keyClick(viewport, Qt::Key_Left, Qt::ControlModifier);
    EXPECT_NEAR(glm::length(camera.backward() - before), 0.0, 1e-9);
    QTest::keyClick(viewport, Qt::Key_Up, Qt::ControlModifier);
    EXPECT_LT(camera.backward().z, before.z - 0.1);
    QTest::keyClick(viewport, Qt::Key_Down, Qt::ControlModifier);
    const glm::dvec3 target = camera.target();
    QTest::keyClick(viewport, Qt::Key_Right, Qt::ShiftModifier);
    EXPECT_LT(camera.target().x, target.x);
    QTest::keyClick(viewport, Qt::Key_Up, Qt::ShiftModifier);
    EXPECT_LT(camera.target().z, target.z);
    const double distance = camera.distance();
    QTest::keyClick(viewport, Qt::Key_PageUp, Qt::ControlModifier);
    EXPECT_LT(camera.distance(), distance);
    QTest::keyClick(viewport, Qt::Key_PageDown, Qt::ControlModifier);
    EXPECT_NEAR(camera.distance(), distance, 1e-9);
    EXPECT_EQ(session_->isovalue().requested(), isovalue);
}

TEST_F(MainWindowTest, TypingDigitsInTheIsovalueFieldLeavesTheCameraAlone) {
    auto* viewport = window_->viewportHost().viewport();
    if (viewport == nullptr)
        GTEST_SKIP() << "no OpenGL 3.3 here";
    openBall();
    const auto before = viewport->camera().backward();
    trigger("isovalue.edit");
    QTest::keyClicks(window_->focusWidget(), QStringLiteral("-7.1"));
    EXPECT_EQ(viewport->camera().backward(), before);
}

// What is applied may change all that undo records: later, of the window only a QWidget is left.
TEST_F(MainWindowTest, ADigitTypedAndNotConfirmedIsAppliedWhileTheWindowIsWhole) {
    openBall();
    trigger("isovalue.edit");
    QTest::keyClicks(window_->focusWidget(), QStringLiteral("-7.1"));
    const QObject* const window = window_.get();
    std::vector<double> whole, late;
    const auto requests = session_->isovalue().observeRequest([&](double isovalue) {
        (qobject_cast<const widgets::MainWindow*>(window) != nullptr ? whole : late).push_back(isovalue);
    });
    window_.reset();
    EXPECT_FALSE(whole.empty());
    EXPECT_TRUE(late.empty());
}

TEST_F(MainWindowTest, B104_WithoutOpenGlThePanelsStillWork) {
    if (window_->viewportHost().viewport() != nullptr)
        GTEST_SKIP() << "OpenGL 3.3 is there";
    EXPECT_TRUE(child<QLabel>("viewportFallback")->text().contains(QStringLiteral("OpenGL 3.3")));
    openBall();
    EXPECT_TRUE(child<QLabel>("viewportFallback")->isVisible());
    session_->isovalue().request(-3.0);
    EXPECT_TRUE(waitUntil([&] { return session_->isovalue().displayed() == -3.0; }));
}

} // namespace
} // namespace isoslider::test
