#pragma once

#include <vector>

namespace isoslider::topology {

/// How many distinct isovalues a volume has, estimated from those in some cubes of it; `factor` times as large as all
/// cubes together.
double distinctInAll(const std::vector<std::vector<double>>& cubes, double factor);

} // namespace isoslider::topology
