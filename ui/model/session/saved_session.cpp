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
#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr int kVersion = 1;

Json toJson(const io::RawLayout& raw) {
    return {{"dims", arrayOf(raw.dims, 3)},
            {"type", std::string(scalarTypeName(raw.type))},
            {"spacing", arrayOf(raw.spacing, 3)},
            {"skipBytes", raw.skipBytes},
            {"bigEndian", raw.isBigEndian}};
}

Json toJson(const io::ReadOptions& options) {
    Json json = Json::object();
    if (options.raw)
        json["raw"] = toJson(*options.raw);
    if (!options.field.empty())
        json["field"] = bytesText(options.field);
    if (options.component)
        json["component"] = *options.component;
    if (options.frame)
        json["frame"] = *options.frame;
    if (options.resampleDims[0] > 0)
        json["size"] = arrayOf(options.resampleDims, 3);
    if (options.allowsExternalData)
        json["allowsExternalData"] = true;
    if (options.allowsTrailing)
        json["allowsTrailing"] = true;
    return json;
}

/// Nothing without dims and type: a headerless file cannot be read by halves.
std::optional<io::RawLayout> rawFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "raw", problems);
    io::RawLayout raw;
    std::string type;
    const bool hasDims = members.dims("dims", raw.dims, 1), hasType = members.text("type", type);
    const auto scalar = hasType ? scalarTypeFromName(type) : std::nullopt;
    if (members.numbers("spacing", raw.spacing, 3) &&
        !(raw.spacing.x > 0.0 && raw.spacing.y > 0.0 && raw.spacing.z > 0.0)) {
        members.reportOf("spacing", "is not positive and ignored");
        raw.spacing = glm::dvec3(1.0);
    }
    members.integer("skipBytes", raw.skipBytes, 0, INT64_MAX);
    members.flag("bigEndian", raw.isBigEndian);
    if (!hasDims || !scalar) {
        members.reportOf("dims or type", "cannot be used");
        return std::nullopt;
    }
    raw.type = *scalar;
    return raw;
}

io::ReadOptions optionsFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "options", problems);
    io::ReadOptions options;
    if (const Json* raw = members.find("raw"))
        options.raw = rawFrom(*raw, problems);
    std::string field;
    if (members.text("field", field)) {
        const auto bytes = bytesFromText(field);
        if (bytes)
            options.field = *bytes;
        else
            members.reportOf("field", "is not valid text and is ignored");
    }
    int component = 0;
    if (members.integer("component", component, io::kMagnitude, INT32_MAX))
        options.component = component;
    std::int64_t frame = 0;
    if (members.integer("frame", frame, 0, INT64_MAX))
        options.frame = frame;
    members.dims("size", options.resampleDims, 2);
    members.flag("allowsExternalData", options.allowsExternalData);
    members.flag("allowsTrailing", options.allowsTrailing);
    return options;
}

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

fs::path volumeFrom(Members& volume, const fs::path& folder) {
    std::string path, relative;
    volume.text("path", path);
    volume.text("relative", relative);
    const auto absolute = bytesFromText(path), below = bytesFromText(relative);
    if (!absolute || !below)
        volume.reportOf("path", "is not valid text and is ignored");
    // What lies beside the session has moved along with it.
    if (below && !below->empty() && isPresent(folder / *below))
        return (folder / *below).lexically_normal();
    return absolute ? fs::path(*absolute) : fs::path();
}

} // namespace

bool isSessionFile(const fs::path& path) { return path.extension() == kSessionSuffix; }

std::string sessionText(const SavedSession& session, const fs::path& folder) {
    Json json{{"isosliderSession", kVersion}};
    Json& volume = json["volume"] = Json::object();
    if (!session.sampleName.empty())
        volume["sample"] = bytesText(session.sampleName);
    if (!session.volume.empty()) {
        volume["path"] = bytesText(session.volume.native());
        const fs::path relative = session.volume.lexically_relative(folder);
        if (!relative.empty() && *relative.begin() != "..")
            volume["relative"] = bytesText(relative.native());
    }
    volume["options"] = toJson(session.readOptions);
    if (session.isovalue && std::isfinite(*session.isovalue))
        json["isovalue"] = *session.isovalue;
    if (!session.surfaces.surfaces.empty())
        json["surfaces"] = surfacesJson(session.surfaces);
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
        Members place(*volume, "volume", problems);
        std::string sample;
        if (place.text("sample", sample))
            read.session.sampleName = bytesFromText(sample).value_or("");
        if (read.session.sampleName.empty())
            read.session.volume = volumeFrom(place, folder);
        else
            volumeFrom(place, folder);
        if (const Json* options = place.find("options"))
            read.session.readOptions = optionsFrom(*options, problems);
    }
    if (!read.session.hasVolume())
        problems.emplace_back("names no volume");
    double isovalue = 0.0;
    if (members.number("isovalue", isovalue))
        read.session.isovalue = isovalue;
    if (const Json* surfaces = members.find("surfaces"))
        read.session.surfaces = surfacesFromJson(*surfaces, problems);
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

std::string optionsText(const io::ReadOptions& options) { return toJson(options).dump(); }

std::optional<io::ReadOptions> optionsFromText(const std::string& text) {
    if (text.size() > kMostSessionBytes)
        return std::nullopt;
    std::vector<std::string> problems;
    const Json json = Json::parse(text, nullptr, false);
    const auto options = optionsFrom(json, problems);
    return problems.empty() ? std::optional(options) : std::nullopt;
}

} // namespace isoslider::model
