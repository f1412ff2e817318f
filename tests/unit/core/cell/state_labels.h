#pragma once

#include <cmath>
#include <compare>
#include <map>
#include <string>
#include <vector>

#include "core/cell/cell_states.h"
#include "tests/support/cell_cases.h"
#include "tests/support/cell_signs.h"
#include "tests/support/slab_oracle.h"

namespace isoslider::cell {

/// What is decided of a cell: the oracle's answer and the product's can be compared.
struct StateLabel {
    int signs = 0;
    int joinedFaces = 0;
    Tunnel tunnel = Tunnel::None;
    auto operator<=>(const StateLabel&) const = default;
};

inline StateLabel labelOf(const test::CellTopology& t) {
    const Tunnel tunnel = t.aboveJoinsInside > 0   ? Tunnel::Above
                          : t.belowJoinsInside > 0 ? Tunnel::Below
                                                   : Tunnel::None;
    return {t.signs, t.joinedFaces, tunnel};
}
inline StateLabel labelOf(const CellState& state) { return {state.signs, state.joinedFaces, state.tunnel}; }

inline std::string toString(const StateLabel& label) {
    static constexpr const char* kTunnels[] = {"none", "above", "below"};
    return "signs " + std::to_string(label.signs) + ", joined faces " + std::to_string(label.joinedFaces) +
           ", tunnel " + kTunnels[static_cast<int>(label.tunnel)];
}

/// The answer of the product.
inline ResolvedCell resolved(const test::CellScalars& scalars, double isovalue) {
    return resolveCell(signsOf(scalars, isovalue), scalars, isovalue);
}
inline const CellState& stateAt(const test::CellScalars& scalars, double isovalue) {
    return cellStates()[resolved(scalars, isovalue).state];
}

/// A random cell without ties at isovalue 0, on a lattice coarse enough for the oracle to be quick.
inline test::CellScalars untiedCell(test::Random& random) {
    const bool isUniform = test::pickInt(random, 0, 3) == 0;
    test::CellScalars scalars = test::randomCell(isUniform ? test::CellKind::Uniform : test::CellKind::Saddle, random);
    for (double& scalar : scalars)
        scalar = std::ldexp(std::round(std::ldexp(scalar, 20)), -20);
    return scalars;
}

/// Cells of every topological class, `perClass` of each, and the labels that the 96 symmetries make of them.
/// Random ones, until for long none was of a new class.
struct ClassWitnesses {
    std::vector<std::vector<test::CellScalars>> classes;
    std::map<StateLabel, std::size_t> classOf;
};

inline ClassWitnesses findClasses(unsigned seed, std::size_t perClass = 1, int patience = 200000) {
    test::Random random(seed);
    ClassWitnesses found;
    for (int idle = 0; idle < patience; ++idle) {
        const test::CellScalars scalars = untiedCell(random);
        const auto [known, isNew] = found.classOf.emplace(labelOf(test::sweepCell(scalars, 0.0)), found.classes.size());
        if (isNew) {
            for (int symmetry = 1; symmetry < 96; ++symmetry)
                found.classOf[labelOf(test::sweepCell(test::turned(scalars, symmetry), 0.0))] = found.classes.size();
            found.classes.emplace_back();
            idle = 0;
        }
        if (auto& witnesses = found.classes[known->second]; witnesses.size() < perClass)
            witnesses.push_back(scalars);
    }
    return found;
}

} // namespace isoslider::cell
