#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <QString>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "ui/model/jobs/index_builder.h"
#include "ui/model/session/session.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/window/main_window.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::test {

inline QString qpath(const std::filesystem::path& path) { return QString::fromStdString(path.string()); }

/// Answers dialogs beforehand; an unexpected one fails the test.
class AnsweringDialogs final : public widgets::FileDialogs {
public:
    std::deque<QString> answers;
    /// Happens while the next dialog is open, before it is answered.
    std::function<void()> meanwhile;

    /// What the last dialog was given; `place` is a folder, or the file suggested.
    struct Asked {
        QString title;
        QString place;
        QString filters;
    } asked;

    void askOpen(QWidget*, const QString& title, const QString& folder, const QString& filters,
                 Chosen chosen) override {
        answer({title, folder, filters}, chosen);
    }
    void askFolder(QWidget*, const QString& title, const QString& folder, Chosen chosen) override {
        answer({title, folder, {}}, chosen);
    }
    void askSave(QWidget*, const QString& title, const QString& suggestion, const QString& filters,
                 Chosen chosen) override {
        answer({title, suggestion, filters}, chosen);
    }
    void askPicture(QWidget*, const widgets::PictureChoice& last, QSize view,
                    std::function<void(const widgets::PictureChoice&)> chosen) override {
        lastPicture = last;
        viewPixels = view;
        chosen(picture.value_or(last));
    }
    /// Chosen for the next picture; none: as it was last.
    std::optional<widgets::PictureChoice> picture;
    widgets::PictureChoice lastPicture;
    QSize viewPixels;

private:
    void answer(const Asked& given, const Chosen& chosen) {
        asked = given;
        ASSERT_FALSE(answers.empty()) << "a dialog nobody expected";
        if (meanwhile)
            std::exchange(meanwhile, nullptr)();
        const QString path = answers.front();
        answers.pop_front();
        chosen(path);
    }
};

/// Builds real indexes, or holds a build until it is cancelled.
class HoldableBuilder final : public model::IndexBuilder {
public:
    Status build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                 const io::VolumeInfo& about, const std::filesystem::path& indexPath, const JobControl& job) override;
    Status buildFromFile(const std::filesystem::path& volume, const io::ReadOptions& options,
                         const std::string& sourceName, const std::filesystem::path& indexPath,
                         const JobControl& job) override;
    Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(const std::shared_ptr<const ScalarGrid>& grid,
                                                                 const JobControl& job) override;
    std::atomic<bool> holds{false};
    std::atomic<bool> holdsEngine{false}; ///< so the first surface does not come
    index::IndexKind kind = index::IndexKind::Metacells; ///< of the next index

private:
    Status buildFrom(io::VolumeSource& source, const std::string& sourceName, const std::filesystem::path& indexPath,
                     const JobControl& job);
};

/// -distance from the middle of an n^3 grid as a MetaImage file of floats: the isosurface at -r is
/// a sphere of radius r cells.
std::filesystem::path writeBall(const TemporaryFolder& folder, const char* name, int n);

/// A double click and the release after it, which QTest leaves out for widgets: without it the button would be
/// down for all that follows.
void doubleClick(QWidget& widget, Qt::MouseButton button, Qt::KeyboardModifiers modifiers, QPoint at);

/// The whole window with real panels, on settings and a separate cache.
class WindowTest : public ::testing::Test {
protected:
    WindowTest();
    ~WindowTest() override;

    /// Handles events until `isDone`; false when that takes too long.
    static bool waitUntil(const std::function<bool()>& isDone,
                          std::chrono::milliseconds longest = std::chrono::seconds(60));
    void makeWindow();
    void openBall(int n = 24);
    bool waitUntilSettled();
    template <class Widget>
    Widget* child(const char* name) {
        auto* found = window_->findChild<Widget*>(QLatin1String(name));
        EXPECT_NE(found, nullptr) << name;
        return found;
    }
    void trigger(const char* actionId);
    void drop(const std::filesystem::path& path);
    /// Writes a picture of a dialog or the window, where pictures are wanted: see CONTRIBUTING.md.
    static void keepPicture(QWidget& widget, const char* name);

    TemporaryFolder folder_;
    AnsweringDialogs dialogs_;
    std::shared_ptr<HoldableBuilder> builder_ = std::make_shared<HoldableBuilder>();
    model::VolumeAccess volumes_; ///< for the next makeWindow()
    model::JobPriority backgroundPriority_ =
        model::JobPriority::Usual; ///< likewise; other tests run beside, which is no user
    std::uint64_t wholeVolumeBytes_ = std::numeric_limits<std::uint64_t>::max(); ///< for the next makeWindow()
    std::unique_ptr<widgets::SettingsStore> settings_;
    std::unique_ptr<model::Session> session_;
    std::unique_ptr<widgets::MainWindow> window_;
};

} // namespace isoslider::test
