#pragma once

#include <optional>

#include <QSize>
#include <QString>
#include <QStringList>

#include "app/exit_code.h"
#include "core/grid/value_spread.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::desktop {

/// What the user asked for when starting the program.
struct CommandLine {
    QString file;
    QStringList furtherFiles; ///< one volume is shown at a time: these are not opened
    QString sample; ///< name of a built-in volume to open instead of a file
    io::ReadOptions readOptions; ///< which volume of the file
    std::optional<AskedIsovalue> isovalue;
    std::optional<QSize> size;
    QString screenshot;
    bool isSelfTest = false;
};

/// The command line, or what to print and the code to exit with.
struct ParsedCommandLine {
    CommandLine commandLine;
    std::optional<ExitCode> exitCode;
    QString output; ///< for stdout on success, for stderr otherwise
};

/// `arguments` as of QCoreApplication::arguments(). Needs no application object for --help, --version
/// and wrong usage.
ParsedCommandLine parseCommandLine(const QStringList& arguments);

} // namespace isoslider::desktop
