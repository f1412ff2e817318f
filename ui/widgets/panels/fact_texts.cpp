#include "ui/widgets/panels/fact_texts.h"

#include <array>

#include <QCoreApplication>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/surface/axis_names.h"

namespace isoslider::widgets {
namespace {

QString tr(const char* text) { return QCoreApplication::translate("FactTexts", text); }

QString joined(const glm::dvec3& v, const QString& pattern) {
    return pattern.arg(fromStd(model::valueText(v.x, 6)), fromStd(model::valueText(v.y, 6)),
                       fromStd(model::valueText(v.z, 6)));
}

} // namespace

QString dimsText(const GridDims& dims) { return QStringLiteral("%1 × %2 × %3").arg(dims[0]).arg(dims[1]).arg(dims[2]); }

QString valueTriple(const glm::dvec3& v) { return joined(v, QStringLiteral("%1 × %2 × %3")); }

QString pointText(const glm::dvec3& v) { return joined(v, QStringLiteral("(%1, %2, %3)")); }

QString typeText(ScalarType type) {
    const auto name = scalarTypeName(type);
    const QString kind = isFloatType(type)     ? tr("floating point")
                         : name.front() == 'u' ? tr("unsigned integer")
                                               : tr("signed integer");
    return QStringLiteral("%1 (%2, %3)")
        .arg(fromStd(std::string(name)), kind, tr("%1 bits").arg(8 * scalarTypeSizeBytes(type)));
}

QString countText(const extract::SurfaceFrame& frame, std::uint64_t count) {
    return frame.region ? tr("%1 about the crop box").arg(grouped(count)) : grouped(count);
}

QString inLengthUnit(const QString& number, const std::string& unit, int power) {
    static const std::array kPowers{QString(), QStringLiteral("²"), QStringLiteral("³")};
    return number + QChar(QChar::Nbsp) + (unit.empty() ? tr("units") : fromStd(unit)) +
           kPowers[static_cast<std::size_t>(power - 1)];
}

QString perLengthUnit(const QString& number, const std::string& unit) {
    const QString text = unit.empty() ? tr("%1 per unit").arg(number) : tr("%1 per %2").arg(number, fromStd(unit));
    return QString(text).replace(QLatin1Char(' '), QChar(QChar::Nbsp));
}

std::vector<Fact> placeFactsOf(const GridGeometry& geometry, const std::string& unit, bool isPatient) {
    const auto withUnit = [&](const QString& text) { return unit.empty() ? text : inLengthUnit(text, unit); };
    const QString tip = unit.empty() ? tr("The file does not state its unit of length") : QString();
    glm::dvec3 size = geometry.spacing;
    for (int axis = 0; axis < 3; ++axis)
        size[axis] *= static_cast<double>(geometry.dims[static_cast<std::size_t>(axis)] - 1);
    std::vector<Fact> facts{{tr("Spacing"), withUnit(valueTriple(geometry.spacing)), tip}};
    if (isPatient) {
        const glm::dvec3 ras = geometry.origin * glm::dvec3(-1.0, -1.0, 1.0) + 0.0; // no negative zeros
        facts.push_back({tr("Origin"), withUnit(fromStd(model::placeText(geometry.origin, true, 6))),
                         tr("%1 in LPS, %2 in RAS, as NIfTI has it").arg(pointText(geometry.origin), pointText(ras))});
        facts.push_back({tr("Coordinates"), tr("LPS"),
                         tr("x grows to the patient's left, y to posterior, z to superior, as in DICOM. NIfTI files "
                            "are RAS: x and y have the opposite sign there")});
    } else {
        facts.push_back({tr("Origin"), withUnit(pointText(geometry.origin)), tip});
    }
    facts.push_back({tr("Box"), withUnit(valueTriple(size)), tr("From the first grid points to the last")});
    if (geometry.direction != glm::dmat3(1.0))
        facts.push_back({tr("Axes"), geometry.isLeftHanded() ? tr("turned, left-handed") : tr("turned"),
                         tr("i %1\nj %2\nk %3")
                             .arg(pointText(geometry.direction[0]), pointText(geometry.direction[1]),
                                  pointText(geometry.direction[2]))});
    return facts;
}

std::vector<Fact> resamplingFactsOf(const std::optional<io::ResampleReport>& report) {
    if (!report)
        return {};
    const QString most = fromStd(model::valueText(report->maxDifference, 3));
    const QString share = fromStd(model::valueText(report->rangeFraction * 100.0, 2));
    std::vector<Fact> facts{{tr("Resampling error"), tr("at most %1, %2 % of the range").arg(most, share),
                             tr("At the %1 points of the file's own grid; root mean square %2")
                                 .arg(fromStd(model::groupedText(report->comparedPoints)),
                                      fromStd(model::valueText(report->rmsDifference, 3)))}};
    if (report->outsidePoints > 0)
        facts.push_back({tr("Outside the grid"),
                         tr("%1 grid points").arg(fromStd(model::groupedText(report->outsidePoints))),
                         tr("Of the resampled grid, in no cell of the file's own: they are missing")});
    return facts;
}

} // namespace isoslider::widgets
