#include "ui/model/topology/question_model.h"

#include <algorithm>
#include <utility>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

std::string inUnit(std::string number, const std::string& unit, int power) {
    return number + " " + (unit.empty() ? "units" : unit) + (power == 2 ? "²" : "³");
}

std::string countText(double count) { return groupedText(static_cast<std::int64_t>(std::clamp(count, -9e18, 9e18))); }

std::string valueInUnit(QueryQuantity quantity, double value, const std::string& unit) {
    return isCount(quantity) ? countText(value) : inUnit(measureText(value), unit, lengthPower(quantity));
}

// "7 pieces", "an area of 12 mm²", "a volume of 12 mm³ above it"
std::string wantedText(const IsovalueQuery& query, const std::string& unit) {
    const std::string value = valueInUnit(query.quantity, query.value, unit), name = nameOf(query.quantity);
    if (isCount(query.quantity))
        return value + " " + (query.value == 1.0 ? name.substr(0, name.size() - 1) : name);
    if (query.quantity == QueryQuantity::Volume)
        return "a volume of " + value + " above it";
    return "an " + name + " of " + value;
}

} // namespace

QuestionModel::QuestionModel(const TopologyModel& topology, std::shared_ptr<BackgroundJobs> jobs)
    : topology_(topology), job_(std::move(jobs)) {
    topologySubscription_ = topology_.changed().observe([this] {
        if (topology_.summary() != searched_) // not where a filter has changed
            search();
    });
}

void QuestionModel::ask(QueryQuantity quantity, std::string typed) {
    if (quantity == quantity_ && typed == typed_)
        return;
    quantity_ = quantity;
    typed_ = std::move(typed);
    search();
}

void QuestionModel::search() {
    job_.cancel();
    if (std::exchange(searched_, topology_.summary()) != topology_.summary())
        found_ = {};
    if (!searched_ || typed_.find_first_not_of(' ') == std::string::npos)
        return settle(QuestionState::Empty);
    const auto query = queryOf(quantity_, typed_);
    if (!query.isOk())
        return settle(QuestionState::Invalid, query.error().message);
    query_ = query.value();
    if (!isKnown(*searched_, quantity_))
        return settle(QuestionState::Failed, std::string("Not known for this volume: ") + nameOf(quantity_));
    state_ = QuestionState::Searching;
    changed_.notify();
    job_.start(
        "Find isovalues",
        [summary = searched_, query = query_](const JobControl&) { return findIsovalues(*summary, query); },
        [this](Result<FoundIsovalues> found) {
            if (!found.isOk())
                return settle(QuestionState::Failed, found.error().line());
            found_ = std::move(found).value();
            state_ = QuestionState::Answered;
            changed_.notify();
        });
}

void QuestionModel::settle(QuestionState state, std::string problem) {
    state_ = state;
    problem_ = std::move(problem);
    found_ = {};
    changed_.notify();
}

std::string QuestionModel::nothingText(const std::string& unit) const {
    const auto bound = [&](double value) { return valueInUnit(query_.quantity, value, unit); };
    std::string text = "No isovalue has " + wantedText(query_, unit);
    if (query_.value > found_.greatest)
        text += "; the most is " + bound(found_.greatest);
    else if (query_.value < found_.least)
        text += "; the least is " + bound(found_.least);
    return text;
}

std::string QuestionModel::answerText(const std::string& unit) const {
    switch (state_) {
        case QuestionState::Empty: return {};
        case QuestionState::Invalid:
        case QuestionState::Failed: return problem_;
        case QuestionState::Searching: return "Searching…";
        case QuestionState::Answered: break;
    }
    if (found_.count == 0)
        return nothingText(unit);
    const std::string name = isCount(query_.quantity) ? "interval" : "isovalue";
    std::string text = groupedText(found_.count) + " " + name + (found_.count == 1 ? "" : "s");
    if (found_.intervals.size() < found_.count)
        text = "The " + groupedText(std::uint64_t{found_.intervals.size()}) + " widest of " + text;
    text += " with " + wantedText(query_, unit);
    return text;
}

} // namespace isoslider::model
