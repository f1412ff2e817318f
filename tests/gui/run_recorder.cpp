#include "tests/gui/run_recorder.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <QPixmap>

#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::test {
namespace {

QString recordFolder() { return qEnvironmentVariable("ISOSLIDER_RECORD_FOLDER"); }

std::string sourceOf(const extract::SurfaceFrame& frame, std::int64_t step) {
    if (frame.isFromIndex)
        return "index";
    return step > 1 ? "preview 1:" + std::to_string(step) : "memory";
}

} // namespace

RunRecorder::RunRecorder(std::string name, widgets::MainWindow& window, model::Session& session)
    : name_(std::move(name)), window_(window), session_(session) {
    subscription_ = session_.frameChanged().observe([this] { noteFrame(); });
    if (auto* viewport = window_.viewportHost().viewport())
        connect(viewport, &widgets::ViewportWidget::painted, this, [this, viewport] {
            if (noted_ == nullptr || viewport->shownIsovalue() != noted_->isovalue)
                return; // a picture of what was there before
            for (auto& row : rows_)
                if (row.painted < 0.0)
                    row.painted = seconds();
        });
    clock_.start();
}

RunRecorder::~RunRecorder() {
    const std::string text = rows_.empty() ? std::string() : table();
    std::fputs(text.c_str(), stdout);
    if (recordFolder().isEmpty())
        return;
    const std::filesystem::path folder(recordFolder().toStdU16String());
    std::filesystem::create_directories(folder);
    if (!text.empty())
        std::ofstream(folder / (name_ + ".txt")) << text;
    for (const auto& [what, image] : pictures_)
        image.save(QString::fromStdU16String((folder / (name_ + "-" + what + ".png")).u16string()));
}

void RunRecorder::begin(const std::string& what) {
    clock_.restart();
    rows_.push_back({what, 0.0, 0.0, {}});
    step_ = what;
}

void RunRecorder::takePicture(const std::string& what) {
    if (!recordFolder().isEmpty())
        pictures_.emplace_back(what, window_.grab().toImage());
}

void RunRecorder::noteFrame() {
    const auto frame = session_.frame();
    if (rows_.empty() || !frame || frame == noted_)
        return;
    noted_ = frame;
    char text[160];
    std::snprintf(text, sizeof text, "%-12s %12.7g %10llu %10.1f", sourceOf(*frame, session_.shownStep()).c_str(),
                  frame->isovalue, static_cast<unsigned long long>(frame->stats.triangles),
                  frame->stats.updateMs + frame->stats.interpolateMs);
    rows_.push_back({step_, seconds(), -1.0, text});
}

std::string RunRecorder::table() const {
    std::string text = name_ + "\n";
    char line[320];
    std::snprintf(line, sizeof line, "%-20s %9s %9s  %-12s %12s %10s %10s\n", "for", "arrived s", "painted s", "from",
                  "isovalue", "triangles", "update ms");
    text += line;
    for (const auto& row : rows_) {
        char painted[16] = "-";
        if (row.painted >= 0.0)
            std::snprintf(painted, sizeof painted, "%.3f", row.painted);
        std::snprintf(line, sizeof line, "%-20s %9.3f %9s  %s\n", row.what.c_str(), row.arrived, painted,
                      row.surface.c_str());
        text += line;
    }
    return text;
}

} // namespace isoslider::test
