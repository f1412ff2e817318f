#include "ui/model/session/saved_session.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/volume_io/parsing/header_checks.h"
#include "ui/model/path_text.h"
#include "ui/model/session/saved_colouring.h"
#include "ui/model/session/saved_slices.h"
#include "ui/model/session/saved_surfaces.h"
#include "ui/model/session/saved_view.h"
#include "ui/model/session/saved_volume.h"
#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr int kVersion = 1;

Json toJson(const CameraPose& camera) {
    const auto& q = camera.orientation;
    return {{"orientation", {q.w, q.x, q.y, q.z}},
            {"target", arrayOf(camera.target, 3)},
            {"distance", camera.distance},
            {"pivot", arrayOf(camera.pivot, 3)},
            {"perspective", camera.isPerspective}};
}

std::optional<CameraPose> cameraFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "camera", problems);
    CameraPose pose;
    std::array<double, 4> turn{1.0, 0.0, 0.0, 0.0};
    const bool hasTurn = members.numbers("orientation", turn, 4);
    const bool hasTarget = members.numbers("target", pose.target, 3);
    const bool hasDistance = members.number("distance", pose.distance);
    const bool hasKind = members.flag("perspective", pose.isPerspective);
    members.numbers("pivot", pose.pivot, 3); // none: the volume's centre
    pose.orientation = glm::dquat(turn[0], turn[1], turn[2], turn[3]);
    Camera camera;
    if (hasTurn && hasTarget && hasDistance && hasKind && camera.setPose(pose))
        return pose;
    members.reportOf("orientation, target or distance", "cannot be used; the whole volume is shown");
    return std::nullopt;
}

Json toJson(const extract::MergeError& error) {
    return {{"in", error.measure == extract::MergeBound::Measure::Distance ? "cells" : "percent"},
            {"amount", error.amount}};
}

std::optional<extract::MergeError> errorFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "error", problems);
    extract::MergeError error;
    std::string unit;
    const bool hasUnit = members.text("in", unit), hasAmount = members.number("amount", error.amount);
    if (!hasUnit || !hasAmount || (unit != "cells" && unit != "percent") || !(error.amount >= 0.0)) {
        members.reportOf("in or amount", "cannot be used; no cells are merged");
        return std::nullopt;
    }
    error.measure = unit == "cells" ? extract::MergeBound::Measure::Distance : extract::MergeBound::Measure::Scalar;
    return error;
}

SecondVolumeState secondFrom(const Json& json, const fs::path& folder, std::vector<std::string>& problems) {
    Members members(json, "second", problems);
    SecondVolumeState second;
    if (const Json* volume = members.find("volume"))
        second.volume = volumeFromJson(*volume, folder, "second, volume", problems);
    const Json* surfaces = members.find("surfaces");
    if (second.volume.isNone())
        members.reportOf("volume", "names no volume and is ignored");
    else if (surfaces != nullptr)
        second.surfaces = surfacesFromJson(*surfaces, problems);
    return second;
}

struct HistogramFlag {
    const char* name;
    bool HistogramOptions::*member;
};
constexpr std::array<HistogramFlag, 4> kHistogramFlags{{{"logCounts", &HistogramOptions::hasLogCounts},
                                                        {"clipsCounts", &HistogramOptions::clipsCounts},
                                                        {"snapsToSamples", &HistogramOptions::snapsToSamples},
                                                        {"snapsToEvents", &HistogramOptions::snapsToEvents}}};
constexpr std::size_t kMostCurves = 32, kMostCurveNameBytes = 64;

Json toJson(const HistogramOptions& options) {
    Json json{{"valueScale", std::string(scaleName(options.valueScale))}};
    for (const auto& [name, member] : kHistogramFlags)
        json[name] = options.*member;
    json["curves"] = options.curves;
    return json;
}

HistogramOptions histogramFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "histogram", problems);
    HistogramOptions options;
    for (const auto& [name, member] : kHistogramFlags)
        members.flag(name, options.*member);
    std::string scale;
    if (members.text("valueScale", scale)) {
        if (const auto kind = scaleFromName(scale))
            options.valueScale = *kind;
        else
            members.reportOf("valueScale", "is neither linear nor log nor symlog and ignored");
    }
    if (const Json* curves = members.find("curves")) {
        const bool areNames =
            curves->is_array() && curves->size() <= kMostCurves &&
            std::all_of(curves->begin(), curves->end(), [](const Json& name) {
                return name.is_string() && name.get_ref<const std::string&>().size() <= kMostCurveNameBytes;
            });
        if (areNames)
            options.curves = curves->get<std::vector<std::string>>();
        else
            members.reportOf("curves", "is not a list of at most 32 names and is ignored");
    }
    return options;
}

std::optional<HistogramRange> rangeFrom(Members& members) {
    std::array<double, 2> ends{};
    if (!members.numbers("histogramRange", ends, 2))
        return std::nullopt;
    if (ends[0] < ends[1])
        return HistogramRange{ends[0], ends[1]};
    members.reportOf("histogramRange", "is not from a lower to a higher value and is ignored");
    return std::nullopt;
}

} // namespace

bool isSessionFile(const fs::path& path) { return path.extension() == kSessionSuffix; }

std::string sessionText(const SavedSession& session, const fs::path& folder) {
    Json json{{"isosliderSession", kVersion}};
    json["volume"] = volumeJson({session.volume, session.sampleName, session.readOptions}, folder);
    if (session.isovalue && std::isfinite(*session.isovalue))
        json["isovalue"] = *session.isovalue;
    if (!session.surfaces.surfaces.empty())
        json["surfaces"] = surfacesJson(session.surfaces);
    if (!session.second.volume.isNone())
        json["second"] = {{"volume", volumeJson(session.second.volume, folder)},
                          {"surfaces", surfacesJson(session.second.surfaces)}};
    if (session.reference && std::isfinite(*session.reference))
        json["reference"] = *session.reference;
    if (session.error)
        json["error"] = toJson(*session.error);
    if (session.camera)
        json["camera"] = toJson(*session.camera);
    if (session.histogram)
        json["histogram"] = toJson(*session.histogram);
    if (session.histogramRange)
        json["histogramRange"] = {session.histogramRange->lower, session.histogramRange->upper};
    if (session.slices)
        json["slices"] = slicesJson(*session.slices);
    if (session.view) {
        json["view"] = viewJson(*session.view);
        json["colouring"] = colouringJson(session.view->colouring, folder);
    }
    return json.dump(2) + "\n";
}

ReadSession sessionFromText(const std::string& text, const fs::path& folder) {
    ReadSession read;
    auto& problems = read.problems;
    if (text.size() > kMostSessionBytes) {
        problems.emplace_back("is larger than a session can be (1 MiB)");
        return read;
    }
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("isosliderSession")) {
        problems.emplace_back(text.empty() ? "is empty" : "is not a session of ISOSLIDER");
        return read;
    }
    Members members(json, "", problems);
    int version = 0;
    if (!members.integer("isosliderSession", version, 1, INT32_MAX) || version > kVersion)
        members.reportOf("isosliderSession", "names a later version; what is known of it is used");
    if (const Json* volume = members.find("volume")) {
        NamedVolume named = volumeFromJson(*volume, folder, "volume", problems);
        read.session.volume = std::move(named.path);
        read.session.sampleName = std::move(named.sampleName);
        read.session.readOptions = std::move(named.readOptions);
    }
    if (!read.session.hasVolume())
        problems.emplace_back("names no volume");
    double isovalue = 0.0;
    if (members.number("isovalue", isovalue))
        read.session.isovalue = isovalue;
    if (const Json* surfaces = members.find("surfaces"))
        read.session.surfaces = surfacesFromJson(*surfaces, problems);
    if (const Json* second = members.find("second"))
        read.session.second = secondFrom(*second, folder, problems);
    double reference = 0.0;
    if (members.number("reference", reference))
        read.session.reference = reference;
    if (const Json* error = members.find("error"))
        read.session.error = errorFrom(*error, problems);
    if (const Json* camera = members.find("camera"))
        read.session.camera = cameraFrom(*camera, problems);
    if (const Json* histogram = members.find("histogram"))
        read.session.histogram = histogramFrom(*histogram, problems);
    read.session.histogramRange = rangeFrom(members);
    if (const Json* slices = members.find("slices"))
        read.session.slices = slicesFromJson(*slices, problems);
    if (const Json* view = members.find("view")) {
        read.session.view = viewFromJson(*view, problems);
        read.session.hasStage = view->is_object() && view->contains("stage");
    }
    read.session.hasColouring = json.contains("colouring");
    if (const Json* colouring = members.find("colouring"); colouring != nullptr && read.session.view)
        read.session.view->colouring = colouringFromJson(*colouring, folder, problems);
    return read;
}

Result<ReadSession> readSession(const fs::path& path) {
    const auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return file.error();
    if (file.value()->sizeBytes() > kMostSessionBytes)
        return sessionFromText(std::string(kMostSessionBytes + 1, ' '), {});
    const auto bytes = readWholeFile(path, kMostSessionBytes);
    if (!bytes.isOk())
        return bytes.error();
    std::error_code ignored;
    return sessionFromText(std::string(reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size()),
                           fs::absolute(path, ignored).parent_path());
}

Status writeSession(const SavedSession& session, const fs::path& path) {
    std::error_code ignored;
    return writeWholeFile(path, sessionText(session, fs::absolute(path, ignored).parent_path()));
}

} // namespace isoslider::model
