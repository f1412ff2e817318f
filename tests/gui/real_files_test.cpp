// Real volumes in the dialogs that open them; skipped where there are none.
#include <QDialog>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QTableView>

#include "tests/gui/window_fixture.h"
#include "tests/support/test_paths.h"
#include "ui/widgets/opening/preview_pane.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(test::sharedFolder()) / "data";

class RealFilesTest : public WindowTest {
protected:
    void SetUp() override {
        if (!fs::exists(kData))
            GTEST_SKIP() << "further test data is not here: " << kData;
    }
    /// The dialog once its preview is there.
    QDialog* shown(const char* name) {
        QDialog* found = nullptr;
        const auto isReady = [&] {
            found = window_->findChild<QDialog*>(QLatin1String(name));
            const auto* progress =
                found != nullptr ? found->findChild<QProgressBar*>(QStringLiteral("previewProgress")) : nullptr;
            const auto* pane = found != nullptr ? found->findChild<widgets::PreviewPane*>() : nullptr;
            return progress != nullptr && !progress->isVisible() && !pane->statusText().isEmpty();
        };
        EXPECT_TRUE(waitUntil(isReady, std::chrono::seconds(30))) << name;
        return found;
    }
    void preview(const char* file, const char* picture) {
        dialogs_.answers.push_back(QString::fromStdString((kData / file).string()));
        trigger("file.open");
        auto* dialog = shown("volumeDialog");
        ASSERT_NE(dialog, nullptr) << file;
        EXPECT_TRUE(dialog->findChild<QPushButton*>(QStringLiteral("volumeOpen"))->isEnabled())
            << file << ": " << dialog->findChild<widgets::PreviewPane*>()->statusText().toStdString();
        keepPicture(*dialog, picture);
        delete dialog;
    }
};

TEST_F(RealFilesTest, AreShownBeforeTheyAreOpened) {
    preview("mhd/cranium.mhd", "real-cranium");
    preview("nifti/mricron_ch2.nii.gz", "real-ch2");
    preview("plot3d/bluntfinq.bin", "real-bluntfin");
    preview("vti/isabel_02.vti", "real-isabel");
}

TEST_F(RealFilesTest, AreArrangedWithoutTheirHeaders) {
    window_->openFile(QString::fromStdString((kData / "mhd/cranium.raw").string()));
    auto* dialog = shown("rawImportDialog");
    ASSERT_NE(dialog, nullptr);
    const auto* guesses = dialog->findChild<QTableView*>(QStringLiteral("rawGuesses"))->model();
    ASSERT_TRUE(waitUntil([&] { return guesses->rowCount() > 0; }, std::chrono::seconds(30)));
    ASSERT_EQ(shown("rawImportDialog"), dialog);
    EXPECT_EQ(dialog->findChild<QSpinBox*>(QStringLiteral("rawDimX"))->value(), 256);
    EXPECT_EQ(dialog->findChild<QSpinBox*>(QStringLiteral("rawDimY"))->value(), 256);
    EXPECT_EQ(dialog->findChild<QSpinBox*>(QStringLiteral("rawDimZ"))->value(), 108);
    keepPicture(*dialog, "real-raw");
}

} // namespace
} // namespace isoslider::test
