#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "core/grid/grid_geometry.h"
#include "core/volume_io/parsing/header_checks.h"
#include "ui/model/surface/measurement.h"

namespace isoslider::model {

using Json = nlohmann::json;

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
    static constexpr std::size_t kMostProblems = 20;
    static constexpr std::size_t kMostNameBytes = 4096;

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
    bool places(const char* name, MeasuredPlaces& places) {
        const Json* json = find(name);
        if (json == nullptr)
            return false;
        const auto isPlace = [](const Json& place) {
            return place.is_array() && place.size() == 3 &&
                   std::all_of(place.begin(), place.end(), [](const Json& number) {
                       return number.is_number() && std::isfinite(number.get<double>());
                   });
        };
        if (!json->is_array() || json->size() > kMostMeasuredPlaces ||
            !std::all_of(json->begin(), json->end(), isPlace))
            return reportOf(name, "is not a list of at most 3 places and is ignored");
        for (const Json& place : *json)
            places.emplace_back(place[0].get<double>(), place[1].get<double>(), place[2].get<double>());
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
    /// Whether it is a whole number within these bounds.
    static bool isWithin(const Json& json, std::int64_t least, std::int64_t most) {
        if (!json.is_number_integer() || (json.is_number_unsigned() && json.get<std::uint64_t>() > INT64_MAX))
            return false;
        const auto value = json.get<std::int64_t>();
        return value >= least && value <= most;
    }

private:
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

/// One of the names; the present value stays where it is none.
template <class Value, std::size_t count>
void choose(Members& members, const char* name, const std::array<const char*, count>& names, Value& value) {
    std::string text;
    if (!members.text(name, text))
        return;
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
        members.reportOf(name, "is not known and ignored");
    else
        value = static_cast<Value>(found - names.begin());
}

} // namespace isoslider::model
