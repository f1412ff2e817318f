// The dialog that shows and limits what indexes take of the disk.

#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QtTest>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/window/cache_dialog.h"

namespace isoslider::test {
namespace {

class CacheDialogTest : public WindowTest {
protected:
    void writeOld(const std::string& name, std::size_t size, int hours) {
        std::filesystem::create_directories(cache());
        const auto path = folder_.write("indexes/" + name, std::string(size, 'x'));
        std::filesystem::last_write_time(path,
                                         std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours));
    }
    std::filesystem::path cache() const { return folder_ / "indexes"; }
    bool has(const char* name) const { return std::filesystem::exists(cache() / name); }
    widgets::CacheDialog* openDialog() {
        trigger("index.cache");
        auto* dialog = window_->findChild<widgets::CacheDialog*>();
        EXPECT_NE(dialog, nullptr);
        EXPECT_TRUE(QTest::qWaitForWindowExposed(dialog));
        QApplication::setActiveWindow(dialog);
        return dialog;
    }
    QString usage(widgets::CacheDialog* dialog) {
        return dialog->findChild<QLabel*>(QStringLiteral("cacheUsage"))->text();
    }
};

TEST_F(CacheDialogTest, ShowsWhatIsThereAndRemovesAll) {
    writeOld("a.isx", 3000, 9);
    writeOld("a.isx.source", 72, 9);
    writeOld("b.isx", 2048, 5);
    auto* dialog = openDialog();
    ASSERT_TRUE(waitUntil([&] { return usage(dialog) == QLatin1String("5.00 KiB in 2 indexes"); }))
        << qPrintable(usage(dialog));
    QTest::mouseClick(dialog->findChild<QPushButton*>(QStringLiteral("cacheClear")), Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return usage(dialog) == QLatin1String("0 B in 0 indexes"); }))
        << qPrintable(usage(dialog));
    EXPECT_TRUE(std::filesystem::is_empty(cache()));
    EXPECT_FALSE(dialog->findChild<QPushButton*>(QStringLiteral("cacheClear"))->isEnabled());
}

TEST_F(CacheDialogTest, KeepsTheIndexInUse) {
    openBall();
    ASSERT_TRUE(has(session_->dataset()->indexPath.filename().c_str()));
    writeOld("a.isx", 3000, 9);
    auto* dialog = openDialog();
    ASSERT_TRUE(waitUntil([&] { return usage(dialog).endsWith(QLatin1String("in 2 indexes")); }));
    QTest::mouseClick(dialog->findChild<QPushButton*>(QStringLiteral("cacheClear")), Qt::LeftButton);
    ASSERT_TRUE(waitUntil([&] { return usage(dialog).endsWith(QLatin1String("in one index")); }))
        << qPrintable(usage(dialog));
    EXPECT_FALSE(has("a.isx"));
    EXPECT_TRUE(std::filesystem::exists(session_->dataset()->indexPath));
}

TEST_F(CacheDialogTest, ANewLimitCountsAtOnceAndStays) {
    writeOld("a.isx", 80u << 20, 9);
    writeOld("b.isx", 60u << 20, 5);
    auto* dialog = openDialog();
    ASSERT_TRUE(waitUntil([&] { return usage(dialog) == QLatin1String("140 MiB in 2 indexes"); }))
        << qPrintable(usage(dialog));
    auto* limit = dialog->findChild<QDoubleSpinBox*>(QStringLiteral("cacheLimit"));
    EXPECT_EQ(limit->value(), 20.0);
    limit->setFocus();
    limit->selectAll();
    QTest::keyClicks(limit, QStringLiteral("0.1"));
    EXPECT_TRUE(has("a.isx")) << "a limit half typed";
    QTest::keyClick(limit, Qt::Key_Tab);
    ASSERT_TRUE(waitUntil([&] { return usage(dialog) == QLatin1String("60.0 MiB in one index"); }))
        << qPrintable(usage(dialog));
    EXPECT_FALSE(has("a.isx"));
    EXPECT_TRUE(has("b.isx"));
    makeWindow();
    EXPECT_EQ(session_->indexCache().limitBytes(), (std::uint64_t{1} << 30) / 10);
}

TEST_F(CacheDialogTest, ABuildMakesRoom) {
    settings_->set("cache/limitGiB", 0.1);
    makeWindow();
    writeOld("a.isx", 103u << 20, 9);
    openBall(24);
    EXPECT_FALSE(has("a.isx"));
    EXPECT_TRUE(std::filesystem::exists(session_->dataset()->indexPath));
}

} // namespace
} // namespace isoslider::test
