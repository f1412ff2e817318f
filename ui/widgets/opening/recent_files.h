#pragma once

#include <vector>

#include <QString>

#include "ui/model/session/recent_file.h"

namespace isoslider::widgets {

class SettingsStore;

/// The files opened lately, newest first, as the settings keep them.
class RecentFiles {
public:
    explicit RecentFiles(SettingsStore& settings) : settings_(settings) {}

    std::vector<model::RecentFile> all() const;
    /// False if it is the newest already.
    bool remember(const model::RecentFile& file);
    void clear();

private:
    SettingsStore& settings_;
};

/// "flow.nc – speed, frame 3", with ampersands doubled: for menus and buttons.
QString recentTitle(const model::RecentFile& file);
/// The path, and in a separate line what was chosen.
QString recentTip(const model::RecentFile& file);

} // namespace isoslider::widgets
