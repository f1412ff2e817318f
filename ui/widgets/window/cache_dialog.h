#pragma once

#include <memory>

#include <QDialog>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/session/index_cache.h"

class QDoubleSpinBox;
class QLabel;
class QPushButton;

namespace isoslider::model {
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class SettingsStore;

/// What the cache of indexes takes of the disk and may take of it. A new limit counts at once. Not modal; deletes
/// itself when it is closed. The folder is looked at and shrunk by a worker thread.
class CacheDialog : public QDialog {
    Q_OBJECT
public:
    CacheDialog(const model::Session& session, SettingsStore& settings, QWidget* parent);

    /// The limit that the settings state, for the session's cache; to be called when the program starts.
    static void applyLimit(const model::Session& session, const SettingsStore& settings);

private:
    using Usage = model::IndexCache::Usage;

    void changeLimit(double gib);
    void look(Usage (model::IndexCache::*change)(const std::filesystem::path& inUse) const);
    void showUsage(const Usage& usage);

    const model::Session& session_;
    SettingsStore& settings_;
    QLabel* usage_;
    QDoubleSpinBox* limit_;
    QPushButton* clear_;
    model::LatestJob<Usage> job_;
};

} // namespace isoslider::widgets
