#include "app/cli/report/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "app/cli/report/text_table.h"

namespace isoslider::cli {
namespace {

constexpr double kWidth = 760, kHeight = 420;
constexpr double kLeft = 84, kTop = 52, kBottom = 62, kLegendWidth = 190;
constexpr double kPlotWidth = kWidth - kLeft - kLegendWidth, kPlotHeight = kHeight - kTop - kBottom;

// Told apart by colour-blind readers too. M. Okabe and K. Ito, Color Universal Design, 2008; without yellow.
constexpr std::array<std::string_view, 7> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                   "#56b4e9", "#e69f00", "#333333"};

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            default:
                if (static_cast<unsigned char>(c) >= 0x20)
                    out += c;
        }
    }
    return out;
}

std::string tickText(double tick) { return withGroups(fmt::format("{:.10g}", tick)); }

/// One axis: which numbers it shows, and where.
class Axis {
public:
    Axis(bool isLog, double least, double greatest) : isLog_(isLog) {
        if (!(least <= greatest)) {
            least = isLog ? 0.1 : 0.0; // nothing to show
            greatest = 1.0;
        }
        isLog ? makeDecades(least, greatest) : makeSteps(least, greatest);
    }

    bool shows(double value) const { return std::isfinite(value) && (!isLog_ || value > 0.0); }
    /// From 0 to 1 along the axis.
    double placeOf(double value) const {
        const double at = isLog_ ? std::log10(value) : value;
        return (at - first_) / (last_ - first_);
    }
    const std::vector<double>& ticks() const { return ticks_; }

private:
    void makeDecades(double least, double greatest) {
        first_ = std::floor(std::log10(least) + 1e-9);
        last_ = std::max(std::ceil(std::log10(greatest) - 1e-9), first_ + 1);
        for (double decade = first_; decade <= last_; ++decade)
            ticks_.push_back(std::pow(10.0, decade));
    }
    // Steps of 1, 2 or 5 times a power of ten; some five of them.
    void makeSteps(double least, double greatest) {
        const double range = greatest > least ? greatest - least : std::max(1.0, std::abs(greatest));
        const double power = std::pow(10.0, std::floor(std::log10(range / 5.0)));
        double step = 10.0 * power;
        for (const double factor : {5.0, 2.0, 1.0})
            if (range / (factor * power) <= 7.0)
                step = factor * power;
        const double from = std::floor(least / step + 1e-9), to = std::ceil(greatest / step - 1e-9);
        first_ = from * step;
        last_ = std::max(to, from + 1) * step;
        for (double k = from; k * step <= last_ + 1e-9 * step; ++k)
            ticks_.push_back(k * step);
    }

    bool isLog_;
    double first_ = 0.0, last_ = 1.0; ///< of a logarithmic axis, exponents
    std::vector<double> ticks_;
};

Axis axisOf(const LinePlot& plot, bool isLog, double (*coordinate)(const std::pair<double, double>&)) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const LinePlot::Line& line : plot.lines)
        for (const auto& point : line.points) {
            const double value = coordinate(point);
            if (!std::isfinite(value) || (isLog && value <= 0.0))
                continue;
            least = std::min(least, value);
            greatest = std::max(greatest, value);
        }
    // A linear axis shows zero where that costs little: lengths can be compared then.
    if (!isLog && least > 0.0 && least < 0.5 * greatest)
        least = 0.0;
    return {isLog, least, greatest};
}

std::string textAt(double x, double y, std::string_view text, std::string_view attributes) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, attributes, escaped(text));
}

std::string ground(const LinePlot& plot, const Axis& x, const Axis& y) {
    std::string out;
    for (const double tick : x.ticks()) {
        const double at = kLeft + x.placeOf(tick) * kPlotWidth;
        out += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"#dddddd\"/>\n", at, kTop,
                           kTop + kPlotHeight);
        out += textAt(at, kTop + kPlotHeight + 18, tickText(tick), "text-anchor=\"middle\"");
    }
    for (const double tick : y.ticks()) {
        const double at = kTop + (1.0 - y.placeOf(tick)) * kPlotHeight;
        out += fmt::format("<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#dddddd\"/>\n", kLeft,
                           kLeft + kPlotWidth, at);
        out += textAt(kLeft - 8, at + 4, tickText(tick), "text-anchor=\"end\"");
    }
    out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888888\"/>\n", kLeft,
                       kTop, kPlotWidth, kPlotHeight);
    out += textAt(kLeft, 28, plot.title, "font-size=\"16\" font-weight=\"bold\"");
    out += textAt(kLeft + kPlotWidth / 2, kHeight - 18, plot.xLabel, "text-anchor=\"middle\"");
    out += textAt(
        0, 0, plot.yLabel,
        fmt::format("text-anchor=\"middle\" transform=\"translate(20 {:.1f}) rotate(-90)\"", kTop + kPlotHeight / 2));
    return out;
}

std::string drawn(const LinePlot::Line& line, const Axis& x, const Axis& y, bool hasDots) {
    const std::string_view colour = kColours[line.colour % kColours.size()];
    std::string points, dots;
    for (const auto& [px, py] : line.points) {
        if (!x.shows(px) || !y.shows(py))
            continue;
        const double atX = kLeft + x.placeOf(px) * kPlotWidth, atY = kTop + (1.0 - y.placeOf(py)) * kPlotHeight;
        points += fmt::format("{:.1f},{:.1f} ", atX, atY);
        if (hasDots)
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", atX, atY, colour);
    }
    if (!points.empty())
        points.pop_back();
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", points, colour,
                       line.isDashed ? " stroke-dasharray=\"6 4\"" : "") +
           dots;
}

} // namespace

std::string LinePlot::svg() const {
    const Axis x = axisOf(*this, isLogX, [](const std::pair<double, double>& point) { return point.first; });
    const Axis y = axisOf(*this, isLogY, [](const std::pair<double, double>& point) { return point.second; });
    std::string out = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
                                  "viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
                                  "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
                                  kWidth, kHeight);
    out += ground(*this, x, y);
    double legendY = kTop + 12;
    for (const Line& line : lines) {
        out += drawn(line, x, y, line.hasDots);
        if (line.name.empty())
            continue;
        const double legendX = kLeft + kPlotWidth + 14;
        out += fmt::format("<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" "
                           "stroke-width=\"2\"{4}/>\n",
                           legendX, legendX + 24, legendY - 4, kColours[line.colour % kColours.size()],
                           line.isDashed ? " stroke-dasharray=\"6 4\"" : "");
        out += textAt(legendX + 32, legendY, line.name, "");
        legendY += 18;
    }
    return out + "</svg>\n";
}

} // namespace isoslider::cli
