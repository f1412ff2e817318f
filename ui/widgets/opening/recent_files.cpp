#include "ui/widgets/opening/recent_files.h"

#include <algorithm>

#include <QDir>

#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr const char* kSetting = "files/recent";
constexpr std::size_t kMostFiles = 10;
constexpr qsizetype kMostChoiceLetters = 48;

} // namespace

std::vector<model::RecentFile> RecentFiles::all() const {
    std::vector<model::RecentFile> files;
    for (const auto& text : settings_.list(kSetting)) {
        auto file = model::recentFromText(text.toStdString());
        if (!file.path.empty() && files.size() < kMostFiles)
            files.push_back(std::move(file));
    }
    return files;
}

bool RecentFiles::remember(const model::RecentFile& file) {
    auto files = all();
    if (!files.empty() && files.front().isSameAs(file))
        return false;
    files.erase(std::remove_if(files.begin(), files.end(), [&](const auto& other) { return other.isSameAs(file); }),
                files.end());
    files.insert(files.begin(), file);
    files.resize(std::min(files.size(), kMostFiles));
    QStringList texts;
    for (const auto& one : files)
        texts << fromStd(model::recentText(one));
    settings_.set(kSetting, texts);
    return true;
}

void RecentFiles::clear() { settings_.set(kSetting, QStringList()); }

QString recentTitle(const model::RecentFile& file) {
    const QString name = QString::fromStdU16String(file.path.filename().u16string());
    QString choices = fromStd(model::choicesText(file)).simplified();
    if (choices.size() > kMostChoiceLetters)
        choices = choices.left(kMostChoiceLetters / 2) + QStringLiteral("…") + choices.right(kMostChoiceLetters / 2);
    QString title = choices.isEmpty() ? name : name + QStringLiteral(" – ") + choices;
    return title.replace(QLatin1Char('&'), QStringLiteral("&&"));
}

QString recentTip(const model::RecentFile& file) {
    const QString path = QDir::toNativeSeparators(QString::fromStdU16String(file.path.u16string()));
    const QString choices = fromStd(model::choicesText(file));
    return plainTip(choices.isEmpty() ? path : path + QLatin1Char('\n') + choices);
}

} // namespace isoslider::widgets
