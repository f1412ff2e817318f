#include "app/desktop/command_line.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include <QCommandLineParser>
#include <QRegularExpression>

namespace isoslider::desktop {
namespace {

ParsedCommandLine wrongUsage(const QString& message) {
    return {{}, ExitCode::WrongUsage, QStringLiteral("isoslider: %1; see isoslider --help\n").arg(message)};
}

std::optional<QSize> parseSize(const QString& text) {
    static const QRegularExpression pattern(QStringLiteral("^([0-9]{2,5})x([0-9]{2,5})$"));
    const auto match = pattern.match(text);
    const QSize size(match.captured(1).toInt(), match.captured(2).toInt());
    const bool isUsable = match.hasMatch() && size.width() >= 64 && size.height() >= 64 && size.width() <= 16384 &&
                          size.height() <= 16384;
    return isUsable ? std::optional(size) : std::nullopt;
}

std::optional<std::int64_t> wholeNumber(const QString& text) {
    bool isNumber = false;
    const qlonglong number = text.toLongLong(&isNumber);
    return isNumber && number >= 0 ? std::optional<std::int64_t>(number) : std::nullopt;
}

std::optional<int> parseComponent(const QString& text) {
    if (text == QLatin1String("magnitude"))
        return io::kMagnitude;
    const auto number = wholeNumber(text);
    return number && *number <= std::numeric_limits<int>::max() ? std::optional(static_cast<int>(*number))
                                                                : std::nullopt;
}

std::optional<AskedIsovalue> parseIsovalueOption(const QString& given) {
    return askedIsovalueFrom(given.toStdString(), [](std::string_view number) {
        bool isNumber = false;
        const double value =
            QString::fromUtf8(number.data(), static_cast<qsizetype>(number.size())).toDouble(&isNumber);
        return isNumber && std::isfinite(value) ? std::optional(value) : std::nullopt;
    });
}

} // namespace

ParsedCommandLine parseCommandLine(const QStringList& arguments) {
    QCommandLineParser parser;
    parser.setApplicationDescription(QStringLiteral("Slides isosurfaces through large volumes."));
    parser.addPositionalArgument(QStringLiteral("FILE"), QStringLiteral("Volume or index to open."),
                                 QStringLiteral("[FILE…]"));
    const QCommandLineOption help({QStringLiteral("h"), QStringLiteral("help")},
                                  QStringLiteral("Show this help and exit."));
    const QCommandLineOption version({QStringLiteral("v"), QStringLiteral("version")},
                                     QStringLiteral("Show the version and exit."));
    const QCommandLineOption isovalue(QStringLiteral("isovalue"),
                                      QStringLiteral("Isovalue to show first, in data units, or as '2.5 sigma'."),
                                      QStringLiteral("X"));
    const QCommandLineOption sample(QStringLiteral("sample"),
                                    QStringLiteral("Open a built-in volume instead of a FILE: bluntfin or shell."),
                                    QStringLiteral("NAME"));
    const QCommandLineOption field(QStringLiteral("field"),
                                   QStringLiteral("Field to open, of a file that holds several."),
                                   QStringLiteral("NAME"));
    const QCommandLineOption frame(QStringLiteral("frame"), QStringLiteral("Frame of a series to open, from 0."),
                                   QStringLiteral("N"));
    const QCommandLineOption component(QStringLiteral("component"),
                                       QStringLiteral("Component of each sample to open, from 0, or 'magnitude'."),
                                       QStringLiteral("N"));
    const QCommandLineOption size(QStringLiteral("size"), QStringLiteral("Size of the window in pixels."),
                                  QStringLiteral("1600x1000"));
    const QCommandLineOption screenshot(
        QStringLiteral("screenshot"),
        QStringLiteral("Write a picture of the window when the surface is shown and the index is ready, then exit."),
        QStringLiteral("out.png"));
    QCommandLineOption selfTest(QStringLiteral("self-test"), QStringLiteral("Start, show a built-in volume and exit."));
    selfTest.setFlags(QCommandLineOption::HiddenFromHelp);
    parser.addOptions({help, version, sample, isovalue, field, frame, component, size, screenshot, selfTest});
    if (!parser.parse(arguments)) {
        QString message = parser.errorText();
        message.remove(QRegularExpression(QStringLiteral("\\.$")));
        return wrongUsage(message);
    }
    if (parser.isSet(help))
        return {{},
                ExitCode::Success,
                parser.helpText().replace(QStringLiteral("<executable_name>"), QStringLiteral("isoslider"))};
    if (parser.isSet(version))
        return {{}, ExitCode::Success, QStringLiteral("isoslider " ISOSLIDER_VERSION "\n")};

    ParsedCommandLine parsed;
    auto& line = parsed.commandLine;
    const QStringList files = parser.positionalArguments();
    line.file = files.value(0);
    line.furtherFiles = files.mid(1);
    line.sample = parser.value(sample);
    if (!line.sample.isEmpty() && !line.file.isEmpty())
        return wrongUsage(QStringLiteral("give a FILE or --sample, not both"));
    if (parser.isSet(isovalue)) {
        line.isovalue = parseIsovalueOption(parser.value(isovalue));
        if (!line.isovalue)
            return wrongUsage(QStringLiteral("--isovalue: '%1' is not a finite number, nor one as '2.5 sigma'")
                                  .arg(parser.value(isovalue)));
    }
    line.readOptions.field = parser.value(field).toStdString();
    if (parser.isSet(frame)) {
        line.readOptions.frame = wholeNumber(parser.value(frame));
        if (!line.readOptions.frame)
            return wrongUsage(QStringLiteral("--frame: '%1' is not a whole number from 0").arg(parser.value(frame)));
    }
    if (parser.isSet(component)) {
        line.readOptions.component = parseComponent(parser.value(component));
        if (!line.readOptions.component)
            return wrongUsage(QStringLiteral("--component: '%1' is neither a whole number from 0 nor 'magnitude'")
                                  .arg(parser.value(component)));
    }
    if (parser.isSet(size)) {
        line.size = parseSize(parser.value(size));
        if (!line.size)
            return wrongUsage(
                QStringLiteral("--size: '%1' is not a size like 1600x1000, 64 to 16384 each").arg(parser.value(size)));
    }
    line.screenshot = parser.value(screenshot);
    if (parser.isSet(screenshot) && line.screenshot.isEmpty())
        return wrongUsage(QStringLiteral("--screenshot needs a file name"));
    line.isSelfTest = parser.isSet(selfTest);
    return parsed;
}

} // namespace isoslider::desktop
