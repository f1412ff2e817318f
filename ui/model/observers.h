#pragma once

#include <functional>
#include <map>
#include <memory>

namespace isoslider::model {

/// Keeps a callback registered while it lives. Movable; outliving the list is harmless.
class Subscription {
public:
    Subscription() = default;
    explicit Subscription(std::function<void()> release) : release_(std::move(release)) {}
    Subscription(Subscription&& other) noexcept : release_(std::move(other.release_)) { other.release_ = nullptr; }
    Subscription& operator=(Subscription&& other) noexcept {
        if (this != &other) {
            reset();
            release_ = std::move(other.release_);
            other.release_ = nullptr;
        }
        return *this;
    }
    ~Subscription() { reset(); }

    void reset() {
        if (release_)
            release_();
        release_ = nullptr;
    }

private:
    std::function<void()> release_;
};

/// Who wants to know that a model changed. One thread (the window's).
template <class... Args>
class ObserverList {
public:
    using Function = std::function<void(Args...)>;

    [[nodiscard]] Subscription observe(Function function) {
        const int id = entries_->nextId++;
        entries_->functions.emplace(id, std::move(function));
        return Subscription([entries = std::weak_ptr<Entries>(entries_), id] {
            if (const auto alive = entries.lock())
                alive->functions.erase(id);
        });
    }

    /// Calls every observer; an observer may subscribe or unsubscribe meanwhile.
    void notify(Args... args) const {
        const auto functions = entries_->functions;
        for (const auto& [id, function] : functions)
            if (entries_->functions.contains(id))
                function(args...);
    }

private:
    struct Entries {
        std::map<int, Function> functions;
        int nextId = 0;
    };
    std::shared_ptr<Entries> entries_ = std::make_shared<Entries>();
};

} // namespace isoslider::model
