#pragma once

#include <string>
#include <vector>

#include <QElapsedTimer>
#include <QImage>
#include <QObject>

#include "ui/model/session/session.h"
#include "ui/widgets/window/main_window.h"

namespace isoslider::test {

/// Notes when each surface of a run arrived and was on screen, and prints it as a table. Where the
/// environment names a folder in ISOSLIDER_RECORD_FOLDER, the table is written there, with a picture of the
/// window for each note that was asked for.
class RunRecorder : public QObject {
public:
    RunRecorder(std::string name, widgets::MainWindow& window, model::Session& session);
    /// Prints and writes what was noted.
    ~RunRecorder() override;

    /// Sets the clock to zero; surfaces are noted from now on.
    void begin(const std::string& what);
    /// What the surfaces from now on are for.
    void setStep(const std::string& what) { step_ = what; }
    /// Takes a picture of the window as it is, if pictures are wanted.
    void takePicture(const std::string& what);
    /// When the newest surface came, in seconds.
    double lastArrival() const { return rows_.back().arrived; }

private:
    struct Row {
        std::string what;
        double arrived = 0.0;
        double painted = -1.0;
        std::string surface;
    };

    double seconds() const { return static_cast<double>(clock_.nsecsElapsed()) * 1e-9; }
    void noteFrame();
    std::string table() const;

    std::string name_;
    widgets::MainWindow& window_;
    model::Session& session_;
    QElapsedTimer clock_;
    std::string step_;
    std::vector<Row> rows_;
    std::vector<std::pair<std::string, QImage>> pictures_; // written at the end: writing takes time
    std::shared_ptr<const extract::SurfaceFrame> noted_;
    model::Subscription subscription_;
};

} // namespace isoslider::test
