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

/// What a model hands out so that others learn of its changes. One thread (the window's).
template <class... Args>
class Observable {
public:
    using Function = std::function<void(Args...)>;

    [[nodiscard]] Subscription observe(Function function) const {
        const int id = entries_->nextId++;
        entries_->functions.emplace(id, std::move(function));
        return Subscription([entries = std::weak_ptr<Entries>(entries_), id] {
            if (const auto alive = entries.lock())
                alive->functions.erase(id);
        });
    }

protected:
    Observable() = default;
    ~Observable() = default;

    struct Entries {
        std::map<int, Function> functions;
        int nextId = 0;
    };
    std::shared_ptr<Entries> entries_ = std::make_shared<Entries>();
};

/// The model's own end of it: only the owner notifies.
template <class... Args>
class ObserverList final : public Observable<Args...> {
public:
    /// Calls every observer; an observer may subscribe or unsubscribe meanwhile.
    void notify(Args... args) const {
        const auto entries = this->entries_; // an observer may end the model
        const auto functions = entries->functions;
        for (const auto& [id, function] : functions)
            if (entries->functions.contains(id))
                function(args...);
    }
};

} // namespace isoslider::model
