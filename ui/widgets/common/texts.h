#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <type_traits>

#include <QString>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::widgets {

inline QString fromStd(const std::string& text) { return QString::fromStdString(text); }

/// "1,234,567"
template <std::integral Count>
QString grouped(Count count) {
    using Widest = std::conditional_t<std::signed_integral<Count>, std::int64_t, std::uint64_t>;
    return fromStd(model::groupedText(static_cast<Widest>(count)));
}

} // namespace isoslider::widgets
