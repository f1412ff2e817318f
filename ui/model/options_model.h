#pragma once

#include <functional>
#include <utility>

#include "ui/model/observers.h"

namespace isoslider::model {

/// Options that are set as a whole; setting equal ones notifies nobody.
template <class Options>
class OptionsModel {
public:
    const Options& options() const { return options_; }
    void setOptions(const Options& options) {
        if (options == options_)
            return;
        options_ = options;
        changed_.notify();
    }
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

private:
    Options options_;
    ObserverList<> changed_;
};

} // namespace isoslider::model
