#include "ui/model/session/saved_session.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/volume_io/parsing/header_checks.h"
#include "ui/model/path_text.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1;
constexpr std::size_t kMostProblems = 20;
constexpr std::size_t kMostNameBytes = 4096;

template <class Values>
Json arrayOf(const Values& values, int count) {
    Json array = Json::array();
    for (int i = 0; i < count; ++i)
        array.push_back(values[i]);
    return array;
}

/// Takes members out of an object one by one, states what is wrong with them, and at last what nobody asked for.
class Members {
public:
    Members(const Json& object, std::string place, std::vector<std::string>& problems)
        : object_(object), place_(std::move(place)), problems_(problems) {
        if (!object_.is_object())
            report("is not an object");
    }
    ~Members() {
        if (object_.is_object())
            for (const auto& [name, value] : object_.items())
                if (std::find(known_.begin(), known_.end(), name) == known_.end())
                    reportOf(inQuotes(name), "is not known and ignored");
    }
    Members(const Members&) = delete;
    Members& operator=(const Members&) = delete;

    /// Null where there is none.
    const Json* find(const char* name) {
        known_.emplace_back(name);
        const auto found = object_.is_object() ? object_.find(name) : object_.end();
        return found == object_.end() ? nullptr : &*found;
    }
    bool number(const char* name, double& value) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        if (!json->is_number() || !std::isfinite(json->get<double>()))
            return reportOf(name, "is not a finite number and is ignored");
        value = json->get<double>();
        return true;
    }
    /// Into at least 0 and at most `most`.
    template <class Integer>
    bool integer(const char* name, Integer& value, std::int64_t least, std::int64_t most) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        if (!isWithin(*json, least, most))
            return reportOf(name, "is not a whole number within its bounds and is ignored");
        value = static_cast<Integer>(json->get<std::int64_t>());
        return true;
    }
    bool flag(const char* name, bool& value) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        if (!json->is_boolean())
            return reportOf(name, "is neither true nor false and ignored");
        value = json->get<bool>();
        return true;
    }
    bool text(const char* name, std::string& value) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        if (!json->is_string() || json->get_ref<const std::string&>().size() > kMostNameBytes)
            return reportOf(name, "is not a text of at most 4096 bytes and is ignored");
        value = json->get<std::string>();
        return true;
    }
    template <class Values>
    bool numbers(const char* name, Values& values, int count) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        bool isGood = json->is_array() && json->size() == static_cast<std::size_t>(count);
        for (int i = 0; isGood && i < count; ++i)
            isGood = (*json)[static_cast<std::size_t>(i)].is_number() &&
                     std::isfinite((*json)[static_cast<std::size_t>(i)].get<double>());
        if (!isGood)
            return reportOf(name, "is not a list of " + std::to_string(count) + " finite numbers and is ignored");
        for (int i = 0; i < count; ++i)
            values[i] = (*json)[static_cast<std::size_t>(i)].get<double>();
        return true;
    }
    bool dims(const char* name, GridDims& values, std::int64_t least) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        bool isGood = json->is_array() && json->size() == 3;
        for (std::size_t i = 0; isGood && i < 3; ++i)
            isGood = isWithin((*json)[i], least, kMaxDim);
        if (!isGood)
            return reportOf(name, "are no three sizes and ignored");
        for (std::size_t i = 0; i < 3; ++i)
            values[i] = (*json)[i].get<std::int64_t>();
        return true;
    }
    bool reportOf(const std::string& name, const std::string& what) {
        return report((place_.empty() ? "" : place_ + ", ") + name + " " + what);
    }

private:
    static bool isWithin(const Json& json, std::int64_t least, std::int64_t most) {
        if (!json.is_number_integer() || (json.is_number_unsigned() && json.get<std::uint64_t>() > INT64_MAX))
            return false;
        const auto value = json.get<std::int64_t>();
        return value >= least && value <= most;
    }
    bool report(std::string text) {
        if (problems_.size() < kMostProblems)
            problems_.push_back(std::move(text));
        return false;
    }

    const Json& object_;
    std::string place_;
    std::vector<std::string>& problems_;
    std::vector<std::string> known_;
};

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

struct OptionName {
    const char* name;
    bool ViewOptions::*member;
};
constexpr std::array<OptionName, 6> kOptionNames{{{"changed", &ViewOptions::showsChanged},
                                                  {"edges", &ViewOptions::showsEdges},
                                                  {"levels", &ViewOptions::showsLevels},
                                                  {"box", &ViewOptions::showsBox},
                                                  {"axes", &ViewOptions::showsAxes},
                                                  {"readout", &ViewOptions::showsReadout}}};

ViewOptions viewFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view", problems);
    ViewOptions view;
    for (const auto& [name, member] : kOptionNames)
        members.flag(name, view.*member);
    return view;
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
    if (session.error)
        json["error"] = toJson(*session.error);
    if (session.camera)
        json["camera"] = toJson(*session.camera);
    if (session.view)
        for (const auto& [name, member] : kOptionNames)
            json["view"][name] = (*session.view).*member;
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
    if (const Json* error = members.find("error"))
        read.session.error = errorFrom(*error, problems);
    if (const Json* camera = members.find("camera"))
        read.session.camera = cameraFrom(*camera, problems);
    if (const Json* view = members.find("view"))
        read.session.view = viewFrom(*view, problems);
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
