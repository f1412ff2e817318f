// Random use: menus, keys, mouse, sizes, panels and files in an order that nobody would think of. It must not crash,
// hang, or make Qt warn. The run follows from its seed, as far as threads allow. By hand, longer:
//   ISOSLIDER_MONKEY_ACTIONS=100000 ISOSLIDER_MONKEY_SEED=7 ISOSLIDER_MONKEY_HANG_MS=1000 ISOSLIDER_MONKEY_LOG=1
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>

#include <QAbstractButton>
#include <QAction>
#include <QComboBox>
#include <QDialog>
#include <QDockWidget>
#include <QElapsedTimer>
#include <QLineEdit>
#include <QMenu>
#include <QPointer>
#include <QTimer>
#include <QtTest>

#include "tests/gui/cones.h"
#include "tests/gui/window_fixture.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {
namespace {

int numberFromEnvironment(const char* name, int fallback) {
    const char* text = std::getenv(name);
    return text != nullptr ? std::atoi(text) : fallback;
}

class Monkey : public WindowTest {
protected:
    Monkey()
        : random_(static_cast<unsigned>(numberFromEnvironment("ISOSLIDER_MONKEY_SEED", 1))),
          isLogged_(numberFromEnvironment("ISOSLIDER_MONKEY_LOG", 0) != 0) {
        writeBall(folder_, "ball.mha", 20);
        writeCones(folder_);
        folder_.write("broken.mha", "ObjectType = Image\nNDims = 3\nDimSize = 4 4\n");
        folder_.write("notes.txt", "no volume\n");
    }

    int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
    bool isOnceIn(int n) { return below(n) == 0; }
    template <class List>
    auto oneOf(const List& list) {
        return list[static_cast<typename List::size_type>(below(static_cast<int>(list.size())))];
    }
    void note(const QString& action) {
        last_ = action;
        if (!isLogged_)
            return;
        std::printf("%d %s\n", number_, qPrintable(action));
        std::fflush(stdout);
    }

    void answerDialogs() {
        static const std::vector<std::string> kNames{
            "ball.mha",       "cones.mha", "broken.mha", "notes.txt", "nowhere.mha", "out.ply", "out.stl",
            "out.isosession", "out.png",   "no/out.ply", ""};
        while (dialogs_.answers.size() < 4) {
            const std::string name = oneOf(kNames);
            dialogs_.answers.push_back(name.empty() ? QString() : qpath(folder_ / name));
        }
    }

    void triggerAny() {
        std::vector<QAction*> actions;
        for (const auto& section : window_->actions().sections())
            for (QAction* action : section.actions)
                if (action->isEnabled() && action != window_->actions().action("file.quit"))
                    actions.push_back(action);
        QAction* action = oneOf(actions);
        note(QStringLiteral("action ") + action->text());
        triggered_.insert(action);
        action->trigger();
    }
    void pressKey() {
        static constexpr std::array kKeys{Qt::Key_Left,   Qt::Key_Right,  Qt::Key_Up,     Qt::Key_Down,  Qt::Key_PageUp,
                                          Qt::Key_Home,   Qt::Key_End,    Qt::Key_Escape, Qt::Key_Enter, Qt::Key_Tab,
                                          Qt::Key_Delete, Qt::Key_Insert, Qt::Key_Space,  Qt::Key_Plus,  Qt::Key_Minus,
                                          Qt::Key_0,      Qt::Key_5,      Qt::Key_A,      Qt::Key_C,     Qt::Key_D,
                                          Qt::Key_H,      Qt::Key_M,      Qt::Key_N,      Qt::Key_V,     Qt::Key_X,
                                          Qt::Key_Z,      Qt::Key_F2,     Qt::Key_Period, Qt::Key_Comma};
        static constexpr std::array<Qt::KeyboardModifier, 6> kModifiers{
            Qt::NoModifier, Qt::NoModifier, Qt::NoModifier, Qt::ShiftModifier, Qt::ControlModifier, Qt::AltModifier};
        const Qt::Key key = oneOf(kKeys);
        const Qt::KeyboardModifier modifier = oneOf(kModifiers);
        QWidget* target = QApplication::focusWidget() != nullptr ? QApplication::focusWidget() : window_.get();
        note(QStringLiteral("key %1 on %2").arg(QKeySequence(key | modifier).toString(), target->objectName()));
        QTest::keyClick(target, key, modifier);
    }
    QPoint placeIn(const QWidget& widget) {
        return {below(std::max(1, widget.width())), below(std::max(1, widget.height()))};
    }
    void useMouse(QWidget& widget) {
        static constexpr std::array<Qt::MouseButton, 5> kButtons{Qt::LeftButton, Qt::LeftButton, Qt::LeftButton,
                                                                 Qt::RightButton, Qt::MiddleButton};
        static constexpr std::array<Qt::KeyboardModifier, 4> kModifiers{Qt::NoModifier, Qt::NoModifier,
                                                                        Qt::ShiftModifier, Qt::ControlModifier};
        const auto button = oneOf(kButtons);
        const auto modifier = oneOf(kModifiers);
        const QPoint from = placeIn(widget);
        note(QStringLiteral("mouse %1 on %2").arg(button).arg(widget.objectName()));
        if (isOnceIn(5))
            return doubleClick(widget, button, modifier, from);
        if (isOnceIn(4)) {
            QWheelEvent wheel(QPointF(from), QPointF(widget.mapToGlobal(from)), {}, {0, isOnceIn(2) ? 120 : -360},
                              Qt::NoButton, modifier, Qt::NoScrollPhase, false);
            QApplication::sendEvent(&widget, &wheel);
            return;
        }
        const QPointer<QWidget> alive(&widget);
        QTest::mousePress(&widget, button, modifier, from);
        for (int moves = below(6); moves > 0 && alive; --moves)
            QTest::mouseMove(&widget, placeIn(widget), 1);
        QWidget* receiver = alive != nullptr ? alive.data() : window_.get();
        QTest::mouseRelease(receiver, button, modifier, placeIn(*receiver));
    }
    void useWidget() {
        QList<QWidget*> widgets;
        for (auto* widget : window_->findChildren<QWidget*>())
            if (widget->isEnabled() && !widget->visibleRegion().isEmpty())
                widgets.push_back(widget);
        if (widgets.isEmpty())
            return;
        QWidget* widget = oneOf(widgets);
        if (auto* edit = qobject_cast<QLineEdit*>(widget)) {
            static const std::array<const char*, 7> kTexts{"0", "-3.5", "1e300", "", "nan", "12,5", "abc"};
            note(QStringLiteral("text in ") + edit->objectName());
            edit->setFocus();
            edit->selectAll();
            QTest::keyClicks(edit, QLatin1String(oneOf(kTexts)));
            QTest::keyClick(edit, Qt::Key_Return);
            return;
        }
        useMouse(*widget);
    }
    void changeWindow() {
        note(QStringLiteral("window"));
        const auto docks = window_->findChildren<QDockWidget*>();
        switch (below(4)) {
            case 0: window_->resize(330 + below(1300), 250 + below(800)); break;
            case 1: oneOf(docks)->setVisible(isOnceIn(2)); break;
            case 2: oneOf(docks)->setFloating(isOnceIn(3)); break;
            default: oneOf(docks)->raise(); break;
        }
    }
    /// A tool button waits for its menu in an event loop, so somebody else has to close it.
    void endPopups() {
        if (auto* popup = QApplication::activePopupWidget(); popup != nullptr && isOnceIn(3)) {
            QTest::keyClick(popup, Qt::Key_Down);
            if (QApplication::activePopupWidget() == popup)
                QTest::keyClick(popup, Qt::Key_Return);
        }
        for (int i = 0; i < 4 && QApplication::activePopupWidget() != nullptr; ++i)
            QApplication::activePopupWidget()->close();
    }
    void endDialogs() {
        for (auto* dialog : window_->findChildren<QDialog*>())
            if (dialog->isVisible() && isOnceIn(4))
                dialog->close();
        if (QApplication::activeWindow() == nullptr || isOnceIn(50))
            QApplication::setActiveWindow(window_.get());
    }
    void act() {
        answerDialogs();
        const int kind = below(100);
        auto* viewport = window_->viewportHost().viewport();
        if (kind < 35)
            triggerAny();
        else if (kind < 55)
            pressKey();
        else if (kind < 68 && viewport != nullptr)
            useMouse(*viewport);
        else if (kind < 78)
            useMouse(window_->isovaluePanel().plot());
        else if (kind < 93)
            useWidget();
        else if (kind < 97)
            changeWindow();
        else {
            static const std::array<const char*, 4> kFiles{"ball.mha", "cones.mha", "broken.mha", "notes.txt"};
            note(QStringLiteral("drop"));
            drop(folder_ / oneOf(kFiles));
        }
        endPopups();
        endDialogs();
    }

    std::mt19937 random_;
    bool isLogged_;
    int number_ = 0;
    QString last_;
    std::set<const QAction*> triggered_;
};

TEST_F(Monkey, FindsNothing) {
    const int actions = numberFromEnvironment("ISOSLIDER_MONKEY_ACTIONS", 600);
    const int longest = numberFromEnvironment("ISOSLIDER_MONKEY_HANG_MS", 5000); // beside other tests
    openBall(20);
    QTimer popups;
    QObject::connect(&popups, &QTimer::timeout, [this] { endPopups(); });
    popups.start(20);
    QElapsedTimer clock;
    qint64 slowest = 0;
    for (number_ = 0; number_ < actions && !HasFailure(); ++number_) {
        SCOPED_TRACE("action " + std::to_string(number_));
        clock.start();
        act();
        QCoreApplication::processEvents();
        const qint64 took = clock.elapsed();
        slowest = std::max(slowest, took);
        EXPECT_LT(took, longest) << last_.toStdString();
        if (isOnceIn(10))
            QTest::qWait(below(30));
        window_->show(); // however it was closed
    }
    EXPECT_TRUE(waitUntilSettled()) << "after " << last_.toStdString();
    std::printf("%d actions, %zu commands, the slowest %lld ms\n", number_, triggered_.size(),
                static_cast<long long>(slowest));
}

} // namespace
} // namespace isoslider::test
