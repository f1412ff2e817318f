#include "app/desktop/sample_loader.h"

#include <array>

#include <QCoreApplication>
#include <QDir>

#include "core/volume_io/sources/sample_volumes.h"

namespace isoslider::desktop {
namespace {

/// The folder that holds `samples`: beside an installed program, or in the source tree of a built one.
std::filesystem::path resourcesFolder() {
    const QDir programs(QCoreApplication::applicationDirPath());
    const std::array<QString, 3> candidates{programs.filePath(QStringLiteral("../share/isoslider/resources")),
                                            programs.filePath(QStringLiteral("../share/isoslider")),
                                            QStringLiteral(ISOSLIDER_SOURCE_RESOURCES)};
    for (const auto& candidate : candidates)
        if (QDir(candidate).exists(QStringLiteral("samples")))
            return std::filesystem::path(QDir::cleanPath(candidate).toStdU16String());
    return std::filesystem::path(candidates.front().toStdU16String());
}

} // namespace

model::SampleLoader makeSampleLoader(const GridDims& dims) {
    return [dims, folder = resourcesFolder()](const std::string& name, const JobControl& job) {
        return io::loadSample(name, dims, folder, job);
    };
}

} // namespace isoslider::desktop
