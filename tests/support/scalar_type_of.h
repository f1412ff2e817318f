#pragma once

#include <type_traits>

#include "core/grid/scalar_type.h"

namespace isoslider::test {

template <class Sample>
ScalarType scalarTypeOf() {
    for (const ScalarType type : kAllScalarTypes)
        if (visitScalarType(type, [](auto sample) { return std::is_same_v<decltype(sample), Sample>; }))
            return type;
    return ScalarType::U8;
}

} // namespace isoslider::test
